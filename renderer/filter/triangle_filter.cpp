#include "renderer/filter/triangle_filter.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// Density (1 - |x| / radius) / radius.
float SampleTent(float u, float radius) {
  if (u < 0.5f) return radius * (std::sqrt(2 * u) - 1);
  return radius * (1 - std::sqrt(std::max(0.0f, 2 - 2 * u)));
}

}  // namespace

FilterSample TriangleFilter::Sample(Point2 u) const {
  return {{SampleTent(u.x, radius_.x), SampleTent(u.y, radius_.y)}, 1};
}

}  // namespace tessera
