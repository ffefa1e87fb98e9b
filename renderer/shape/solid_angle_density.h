// From densities per area to densities per solid angle, and the cosine warp that spherical sampling shares.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "renderer/math/float4.h"
#include "renderer/shape/shape_queries.h"
#include "renderer/shape/spherical_sampling.h"

namespace tessera {

// A density per area at point p with normal n, as a density per solid angle from `from`; 0 where it is not
// finite.
inline float PerSolidAngle(float pdf_per_area, Point3 from, Point3 p, Normal3 n) {
  const Vec3 d = p - from;
  const float distance_squared = LengthSquared(d);
  const float cosine = AbsDot(n, d) / std::sqrt(distance_squared);
  const float pdf = pdf_per_area * distance_squared / cosine;
  return std::isfinite(pdf) ? pdf : 0;
}

// Converts the pdf of `sample` from area to solid angle. Returns nullopt if the point cannot be seen.
inline std::optional<ShapeSample> SeenFrom(const ReferencePoint& reference, ShapeSample sample) {
  sample.pdf = PerSolidAngle(sample.pdf, reference.p, sample.p, sample.n);
  if (!(sample.pdf > 0)) return std::nullopt;
  return sample;
}

// The weight of a corner: the cosine at the reference point's surface, at least kCornerCosineMin so that no
// direction is never chosen.
constexpr float kCornerCosineMin = 0.01f;  // as pbrt's
inline float CornerWeight(const ReferencePoint& reference, Point3 corner) {
  return std::max(kCornerCosineMin, AbsDot(reference.shading_n, Normalize(corner - reference.p)));
}
// The same for four corners, given by their coordinates.
inline Float4 CornerWeights(const ReferencePoint& reference, Float4 x, Float4 y, Float4 z) {
  x = x - reference.p.x;
  y = y - reference.p.y;
  z = z - reference.p.z;
  const Float4 inverse = 1 / Sqrt(x * x + y * y + z * z);
  const Normal3 n = reference.shading_n;
  const Float4 cosines = n.x * (x * inverse) + n.y * (y * inverse) + n.z * (z * inverse);
  return Max(Abs(cosines), Float4(kCornerCosineMin));
}

inline bool IsOnSurface(const ReferencePoint& reference) {
  return !IsZero(reference.shading_n);
}

}  // namespace tessera
