// The filter "triangle": falls linearly to the radius.
#pragma once

#include "renderer/filter/filter_reader.h"

namespace tessera {

class TriangleFilter {
 public:
  static TriangleFilter Read(ParameterReader& reader) { return TriangleFilter(ReadRadius(reader, 2)); }

  explicit TriangleFilter(Vec2 radius) : radius_(radius) {}

  FilterSample Sample(Point2 u) const;
  float Evaluate(Vec2 offset) const {
    return (radius_.x - std::abs(offset.x)) * (radius_.y - std::abs(offset.y));
  }
  Vec2 radius() const { return radius_; }

 private:
  Vec2 radius_;
};

}  // namespace tessera
