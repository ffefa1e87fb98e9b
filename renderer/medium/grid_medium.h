// A medium whose density varies on a grid, and what it emits.
#pragma once

#include <memory>
#include <optional>

#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/medium/grid_ray.h"
#include "renderer/medium/phase_function.h"
#include "renderer/medium/voxel_grid.h"

namespace tessera {

struct HomogeneousCoefficients;

using FloatGrid = VoxelGrid<float>;

// How temperatures become emission: that of a black body with (temperature - offset) * scale kelvin, whose
// spectrum has its maximum at 1.
struct TemperatureScale {
  float offset = 0, scale = 1;
  // Reads `temperatureoffset`, or `temperaturecutoff`, and `temperaturescale`.
  static TemperatureScale Read(ParameterReader& reader);
};

// What the kinds of medium with a density grid are made of. The grids have the same size. Immutable.
struct GridContents {
  DenseTable sigma_a{}, sigma_s{}, radiance{};  // at density 1; radiance at a scale of 1
  std::shared_ptr<const FloatGrid> density;
  MajorantGrid density_max;
  // Of the emission: the temperature, which replaces `radiance`, and a factor. May be null.
  std::shared_ptr<const FloatGrid> temperature, radiance_scale;
  TemperatureScale temperature_scale;
  float radiance_factor = 1;
  GridPlacement placement;
  bool is_emissive = false;
};

// At the wavelengths of a path: a Field of GridRay.
class GridCoefficients {
 public:
  GridCoefficients(const GridContents& grid, const SampledWavelengths& wavelengths);

  GridRay<GridCoefficients> RayAlong(const Ray& ray) const { return {*this, ray}; }
  const HomogeneousCoefficients* Homogeneous() const { return nullptr; }
  bool MayCollide() const { return true; }
  float CollisionDistanceMax(float) const { return std::numeric_limits<float>::infinity(); }

  const GridPlacement& placement() const { return grid_->placement; }
  const MajorantGrid& majorants() const { return grid_->density_max; }
  SampledSpectrum MajorantOf(float bound) const { return (sigma_a_ + sigma_s_) * bound; }
  MediumPoint PointAt(Point3 position) const {
    const float density = grid_->density->Lookup(position);
    MediumPoint point{sigma_a_ * density, sigma_s_ * density, SampledSpectrum()};
    if (grid_->is_emissive && density > 0) point.emission = point.sigma_a * RadianceAt(position);
    return point;
  }

 private:
  SampledSpectrum RadianceAt(Point3 position) const;

  const GridContents* grid_;
  SampledSpectrum lambda_, sigma_a_, sigma_s_, radiance_;
};

// `uniformgrid`. Immutable.
class UniformGridMedium {
 public:
  // Reads `nx`, `ny`, `nz`, `density`, `sigma_a`, `sigma_s`, `scale`, `Le`, `Lescale`, `temperature` and its
  // scale, `p0`, `p1` and `g`; errors are remembered by the reader.
  static UniformGridMedium Read(ParameterReader& reader, const Transform& render_from_medium,
                                FileSource& files, Diagnostics& diagnostics);

  GridCoefficients At(const SampledWavelengths& wavelengths) const { return {*grid_, wavelengths}; }
  const PhaseFunction& phase() const { return phase_; }
  bool is_emissive() const { return grid_->is_emissive; }

 private:
  std::shared_ptr<const GridContents> grid_;
  PhaseFunction phase_;
};

// Reads `sigma_a`, `sigma_s` and `scale` into a grid whose density and placement are known. Remembers an
// error if the coefficients are too large at the largest density.
void ReadGridCoefficients(ParameterReader& reader, FileSource& files, GridContents& grid);

}  // namespace tessera
