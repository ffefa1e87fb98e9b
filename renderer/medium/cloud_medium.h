// A cloud made of noise.
#pragma once

#include <memory>

#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/medium/grid_ray.h"
#include "renderer/medium/phase_function.h"

namespace tessera {

struct HomogeneousCoefficients;

// Its shape, in the space of the medium: flat below y = 0.5, wisps above, nothing above y = 1 where the noise
// is positive. That of pbrt-v4.
struct CloudShape {
  float density = 1, wispiness = 1, frequency = 5;

  // In [0, 1].
  float DensityAt(Point3 p) const;
  // At least the density of all points with y0 <= y <= y1.
  float Bound(float y0, float y1) const;
};

// Immutable.
struct CloudContents {
  CloudShape shape;
  DenseTable sigma_a{}, sigma_s{};  // at density 1
  MajorantGrid density_max;         // layers along y
  GridPlacement placement;
  Point3 origin;  // of the positions, in the space of the medium
  Vec3 per_position;
};

// At the wavelengths of a path: a Field of GridRay.
class CloudCoefficients {
 public:
  CloudCoefficients(const CloudContents& cloud, const SampledWavelengths& wavelengths);

  GridRay<CloudCoefficients> RayAlong(const Ray& ray) const { return {*this, ray}; }
  const HomogeneousCoefficients* Homogeneous() const { return nullptr; }
  bool MayCollide() const { return true; }
  float CollisionDistanceMax(float) const { return std::numeric_limits<float>::infinity(); }

  const GridPlacement& placement() const { return cloud_->placement; }
  const MajorantGrid& majorants() const { return cloud_->density_max; }
  SampledSpectrum MajorantOf(float bound) const { return (sigma_a_ + sigma_s_) * bound; }
  MediumPoint PointAt(Point3 position) const {
    const Vec3& scale = cloud_->per_position;
    const float density = cloud_->shape.DensityAt(
        cloud_->origin + Vec3{position.x * scale.x, position.y * scale.y, position.z * scale.z});
    return {sigma_a_ * density, sigma_s_ * density, SampledSpectrum()};
  }

 private:
  const CloudContents* cloud_;
  SampledSpectrum sigma_a_, sigma_s_;
};

// `cloud`. Immutable.
class CloudMedium {
 public:
  // Reads `density`, `wispiness`, `frequency`, `sigma_a`, `sigma_s`, `p0`, `p1` and `g`; errors are
  // remembered by the reader.
  static CloudMedium Read(ParameterReader& reader, const Transform& render_from_medium, FileSource& files,
                          Diagnostics& diagnostics);

  CloudCoefficients At(const SampledWavelengths& wavelengths) const { return {*cloud_, wavelengths}; }
  const PhaseFunction& phase() const { return phase_; }
  bool is_emissive() const { return false; }

 private:
  std::shared_ptr<const CloudContents> cloud_;
  PhaseFunction phase_;
};

}  // namespace tessera
