// A small bounding volume hierarchy that finds *all* boxes along a ray, for densities over every light in a
// direction. Immutable and deterministic; a query allocates nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/math/ray.h"

namespace tessera {

class EmitterTree {
 public:
  EmitterTree() = default;
  explicit EmitterTree(std::span<const Bounds3> boxes);

  // Calls visit(index of the box) for every box that the ray may hit, and perhaps for a few more, always in
  // the same order.
  template <typename Visit>
  void ForEachAlong(const Ray& ray, const Visit& visit) const {
    if (nodes_.empty()) return;
    const Vec3 inverse{1 / ray.d.x, 1 / ray.d.y, 1 / ray.d.z};
    uint32_t stack[kDepthMax];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const uint32_t index = stack[--size];
      const Node& node = nodes_[index];
      if (!MayMeet(node.box, ray, inverse)) continue;
      if (node.count == 0) {
        stack[size++] = node.first;
        stack[size++] = index + 1;
      }
      for (uint32_t i = 0; i < node.count; ++i) visit(order_[node.first + i]);
    }
  }

 private:
  static constexpr int kDepthMax = 64;          // halving 2^32 boxes needs 33
  static constexpr uint32_t kLeafBoxesMax = 4;  // cheaper tested than split

  struct Node {
    Bounds3 box;
    // Leaf: index into order_; otherwise the second child, as the first follows its parent.
    uint32_t first = 0;
    uint32_t count = 0;  // of boxes; 0: not a leaf
  };

  // Returns true if a NaN (a ray in the plane of a side) leaves it undecided.
  static bool MayMeet(const Bounds3& box, const Ray& ray, Vec3 inverse) {
    float near = 0, far = ray.t_max;
    for (int i = 0; i < 3; ++i) {
      const float a = (box.min[i] - ray.o[i]) * inverse[i];
      const float b = (box.max[i] - ray.o[i]) * inverse[i];
      constexpr float kSlack = 1 + 4 * std::numeric_limits<float>::epsilon();
      const float first = a < b ? a : b, last = (a < b ? b : a) * kSlack;
      if (first > near) near = first;
      if (last < far) far = last;
    }
    return !(near > far);
  }
  uint32_t Build(std::span<const Bounds3> boxes, uint32_t begin, uint32_t end);

  std::vector<Node> nodes_;  // the first is the root
  std::vector<uint32_t> order_;
};

}  // namespace tessera
