// A medium whose density and temperature are sparse grids of a file.
#pragma once

#include <memory>

#include "renderer/medium/grid_medium.h"

namespace tessera {

// `nanovdb`. Immutable.
class NanoVdbMedium {
 public:
  // Reads `filename`, `gridname`, `temperaturename`, `sigma_a`, `sigma_s`, `scale`, `Lescale`, the scale of
  // temperatures and `g`; errors are remembered by the reader. The file has voxels at whole indices, and the
  // medium ends one voxel after the last active one, as in pbrt-v4. A medium without temperatures is dark.
  static NanoVdbMedium Read(ParameterReader& reader, const Transform& render_from_medium, FileSource& files,
                            Diagnostics& diagnostics);

  GridCoefficients At(const SampledWavelengths& wavelengths) const { return {*grid_, wavelengths}; }
  const PhaseFunction& phase() const { return phase_; }
  bool is_emissive() const { return grid_->is_emissive; }

 private:
  std::shared_ptr<const GridContents> grid_;
  PhaseFunction phase_;
};

}  // namespace tessera
