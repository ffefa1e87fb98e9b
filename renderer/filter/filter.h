// Pixel filters by importance sampling: a sample's place is drawn with density proportional to the filter's
// magnitude, so every sample belongs to one pixel and carries a weight of +1 or -1.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/math/vec.h"
#include "renderer/util/result.h"

namespace tessera {

struct FilterSample {
  Vec2 offset;  // from the pixel's centre, in pixels
  float weight = 1;
};

// One axis of a separable filter as a piecewise linear function over [-radius, radius], sampled by inversion.
class FilterAxis {
 public:
  FilterAxis() = default;
  // `f` is sampled at evenly spaced nodes; it is symmetric.
  FilterAxis(float radius, float (*f)(float x, float radius, const float* parameters),
             const float* parameters);

  // An offset with density |f|, and the sign of f there.
  float Sample(float u, float* sign) const;
  float Evaluate(float x) const;

 private:
  int IntervalOf(float u) const;  // u in [0, 1)
  float radius_ = 0;
  std::vector<float> value_;     // at the nodes
  std::vector<float> cdf_;       // of |f| up to each node, 1 at the last
  std::vector<uint16_t> guide_;  // the interval of the least u of each of equal parts of [0, 1)
};

// Immutable.
class Filter {
 public:
  // Reads a PixelFilter directive: box, gaussian, mitchell, sinc or triangle.
  static Result<Filter> Read(const Entity& entity);

  // u in [0, 1)^2.
  FilterSample Sample(Point2 u) const;
  // Proportional to the filter; 0 outside its radius.
  float Evaluate(Vec2 offset) const;
  Vec2 radius() const { return radius_; }

 private:
  enum class Kind { kBox, kTriangle, kTabulated };
  Kind kind_ = Kind::kBox;
  Vec2 radius_{0.5f, 0.5f};
  FilterAxis x_, y_;
};

}  // namespace tessera
