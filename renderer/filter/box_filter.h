// The filter "box": the same weight everywhere.
#pragma once

#include "renderer/filter/filter_reader.h"

namespace tessera {

class BoxFilter {
 public:
  static BoxFilter Read(ParameterReader& reader) { return BoxFilter(ReadRadius(reader, 0.5f)); }

  explicit BoxFilter(Vec2 radius = {0.5f, 0.5f}) : radius_(radius) {}

  FilterSample Sample(Point2 u) const {
    return {{Lerp(u.x, -radius_.x, radius_.x), Lerp(u.y, -radius_.y, radius_.y)}, 1};
  }
  float Evaluate(Vec2) const { return 1; }
  Vec2 radius() const { return radius_; }

 private:
  Vec2 radius_;
};

}  // namespace tessera
