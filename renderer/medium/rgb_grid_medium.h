// A medium whose coefficients have a colour at each voxel of a grid.
#pragma once

#include <memory>

#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/medium/grid_ray.h"
#include "renderer/medium/phase_function.h"
#include "renderer/medium/voxel_grid.h"

namespace tessera {

struct HomogeneousCoefficients;

// The smooth spectrum of an RGB triple: `scale` times the polynomial.
struct RgbVoxel {
  SigmoidPolynomial polynomial;
  float scale = 0;

  bool operator==(const RgbVoxel& other) const { return scale == 0 && other.scale == 0; }
  SampledSpectrum Sample(const SampledWavelengths& wavelengths) const {
    return scale == 0 ? SampledSpectrum() : polynomial.Sample(wavelengths) * scale;
  }
  // At least the largest value over the visible range.
  float Bound() const;
};
using RgbGrid = VoxelGrid<RgbVoxel>;

// Grids of the same size. Immutable.
struct RgbGridContents {
  std::shared_ptr<const RgbGrid> sigma_a, sigma_s;  // null: 1 everywhere
  std::shared_ptr<const RgbGrid> radiance;          // times the illuminant; null: dark
  std::shared_ptr<const DenseTable> illuminant;
  float scale = 1, radiance_factor = 1;
  MajorantGrid sigma_max;  // of the sum of both, before `scale`
  GridPlacement placement;
};

// At the wavelengths of a path: a Field of GridRay.
class RgbGridCoefficients {
 public:
  RgbGridCoefficients(const RgbGridContents& grid, const SampledWavelengths& wavelengths);

  GridRay<RgbGridCoefficients> RayAlong(const Ray& ray) const { return {*this, ray}; }
  const HomogeneousCoefficients* Homogeneous() const { return nullptr; }
  bool MayCollide() const { return true; }
  float CollisionDistanceMax(float) const { return std::numeric_limits<float>::infinity(); }

  const GridPlacement& placement() const { return grid_->placement; }
  const MajorantGrid& majorants() const { return grid_->sigma_max; }
  SampledSpectrum MajorantOf(float bound) const { return SampledSpectrum(bound * grid_->scale); }
  MediumPoint PointAt(Point3 position) const;

 private:
  const RgbGridContents* grid_;
  SampledWavelengths wavelengths_;
  SampledSpectrum illuminant_;  // times the factor of the radiance
};

// `rgbgrid`. Immutable.
class RgbGridMedium {
 public:
  // Reads `nx`, `ny`, `nz`, `sigma_a`, `sigma_s`, `scale`, `Le`, `Lescale`, `p0`, `p1` and `g`; errors are
  // remembered by the reader.
  static RgbGridMedium Read(ParameterReader& reader, const Transform& render_from_medium, FileSource& files,
                            Diagnostics& diagnostics);

  RgbGridCoefficients At(const SampledWavelengths& wavelengths) const { return {*grid_, wavelengths}; }
  const PhaseFunction& phase() const { return phase_; }
  bool is_emissive() const { return grid_->radiance != nullptr && grid_->radiance_factor > 0; }

 private:
  std::shared_ptr<const RgbGridContents> grid_;
  PhaseFunction phase_;
};

}  // namespace tessera
