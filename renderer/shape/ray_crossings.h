// Where a ray meets one primitive, by the exact test of its form.
#pragma once

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The nearest crossing of the shape's primitive with t in (0, t_max]; false if there is none. `ray` is in the
// space of the shape.
inline bool NearestCrossing(const Shape& shape, uint32_t primitive, const DoubleRay& ray, double t_max,
                            Crossing* crossing) {
  return Dispatch(shape.form,
                  [&](const auto& form) { return form.Intersect(primitive, ray, t_max, crossing); });
}

// Where the search for a second crossing starts, relative to the distance of the first: well above the
// rounding of doubles, well below that of the rays' own floats.
constexpr double kBeyondCrossing = 1 + 1e-9;

// The nearest crossing beyond one at distance `t`.
inline bool NextCrossing(const Shape& shape, uint32_t primitive, const DoubleRay& ray, double t, double t_max,
                         Crossing* crossing) {
  const double skipped = t * kBeyondCrossing;
  const DoubleRay rest{ray.At(skipped), ray.d};
  if (!NearestCrossing(shape, primitive, rest, t_max - skipped, crossing)) return false;
  crossing->t += skipped;
  return true;
}

// A line meets a quadric or a bilinear patch at most twice. Of a piece of a curve only two crossings count.
constexpr int kCrossingsMax = 2;

// All crossings, as a density over directions needs them: the hits of the primitive of `shape` that `name`
// names, with t in (0, ray.ray.t_max], in ascending order. Returns their number. Ignores alpha.
int RayCrossings(const Shape& shape, const HitRay& ray, const Hit& name, Hit hits[kCrossingsMax]);

}  // namespace tessera
