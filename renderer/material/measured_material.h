// Materials whose reflection was measured: the RGL database and other files of the same format.
#pragma once

#include <memory>

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameter: string filename (required), a .bsdf file (measured_brdf_file.h).
struct MeasuredMaterial {
  std::shared_ptr<const MeasuredBrdf> brdf;  // shared by materials of the same file; null after an error

  static MeasuredMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return false; }
  bool IsIsotropic() const { return false; }
  Bxdf MakeBxdf(const MaterialContext& at) const { return MeasuredBxdf(*brdf, at.wavelengths.lambda); }
};

}  // namespace tessera
