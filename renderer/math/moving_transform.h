// Transforms that change over time, prepared for rays of any time.
#pragma once

#include <span>
#include <vector>

#include "renderer/math/animated_transform.h"
#include "renderer/math/motion.h"

namespace tessera {

// A product of transforms, some of which move. Immutable.
class MovingTransform {
 public:
  // The last of `factors` is applied first. All must be affine at all keys.
  explicit MovingTransform(std::span<const AnimatedTransform> factors);

  // Flat (flat_transform.h) if it is singular at that time; otherwise with the inverse of its very matrix.
  Transform At(float time_s) const;
  // A box around all that the map makes of the points of `box` in the times from `from_s` to `to_s`.
  Bounds3 BoundsOf(const Bounds3& box, float from_s, float to_s) const;

  uint64_t bytes() const;  // in addition to the object itself

 private:
  // Between two keys.
  struct Segment {
    double start_s, end_s;
    TransformPath path;

    float FractionAt(double time_s) const {
      return static_cast<float>((time_s - start_s) / (end_s - start_s));
    }
  };
  // The first map before all segments, the last one after them; the same if there are none.
  struct Factor {
    Transform first, last;
    double first_s = 0, last_s = 0;  // times of the first and last key
    std::vector<Segment> segments;

    Transform At(double time_s) const;
    Bounds3 BoundsOf(const Bounds3& box, double from_s, double to_s) const;
  };
  static Factor MakeFactor(const AnimatedTransform& transform);

  std::vector<Factor> factors_;
};

}  // namespace tessera
