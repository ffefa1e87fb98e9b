// Pixel filters by importance sampling: a sample's place is drawn with density proportional to the filter's
// magnitude, so every sample belongs to one pixel and carries a weight of +1 or -1.
//
// To add a kind of filter, write a class that satisfies FilterKind in files of its own, append it to Filter's
// variant and give it a row in filter.cpp.
#pragma once

#include <concepts>
#include <variant>

#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"
#include "renderer/filter/box_filter.h"
#include "renderer/filter/tabulated_filter.h"
#include "renderer/filter/triangle_filter.h"
#include "renderer/math/vec.h"
#include "renderer/util/dispatch.h"
#include "renderer/util/result.h"

namespace tessera {

template <typename T>
concept FilterKind = requires(const T& filter, Point2 u, Vec2 offset) {
  { filter.Sample(u) } -> std::same_as<FilterSample>;
  // Within the radius.
  { filter.Evaluate(offset) } -> std::same_as<float>;
  { filter.radius() } -> std::same_as<Vec2>;
};

template <FilterKind... Kinds>
using FilterOf = std::variant<Kinds...>;
using AnyFilter = FilterOf<BoxFilter, TriangleFilter, TabulatedFilter>;

// Immutable.
class Filter {
 public:
  // Reads a PixelFilter directive.
  static Result<Filter> Read(const Entity& entity);

  Filter() = default;
  Filter(AnyFilter kind) : kind_(std::move(kind)) {}

  // u in [0, 1)^2.
  FilterSample Sample(Point2 u) const;
  // Proportional to the filter; 0 outside its radius.
  float Evaluate(Vec2 offset) const;
  Vec2 radius() const;

 private:
  AnyFilter kind_;
};

KindList FilterKinds();

}  // namespace tessera
