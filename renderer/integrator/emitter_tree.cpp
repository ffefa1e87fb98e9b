#include "renderer/integrator/emitter_tree.h"

#include <algorithm>
#include <numeric>

namespace tessera {

EmitterTree::EmitterTree(std::span<const Bounds3> boxes) {
  if (boxes.empty()) return;
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.reserve(boxes.size());
  Build(boxes, 0, static_cast<uint32_t>(boxes.size()));
}

// Halves the boxes at the median of their centres along the longest axis.
uint32_t EmitterTree::Build(std::span<const Bounds3> boxes, uint32_t begin, uint32_t end) {
  const uint32_t index = static_cast<uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Bounds3 box, centers;
  for (uint32_t i = begin; i < end; ++i) {
    box.Add(boxes[order_[i]]);
    centers.Add(boxes[order_[i]].Center());
  }
  nodes_[index].box = box;
  if (end - begin <= kLeafBoxesMax) {
    nodes_[index].first = begin;
    nodes_[index].count = end - begin;
    return index;
  }
  const Vec3 extent = centers.Diagonal();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const uint32_t middle = begin + (end - begin) / 2;
  const auto before = [&](uint32_t a, uint32_t b) {
    const float center_a = boxes[a].Center()[axis], center_b = boxes[b].Center()[axis];
    return center_a != center_b ? center_a < center_b : a < b;
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, before);
  Build(boxes, begin, middle);
  const uint32_t second = Build(boxes, middle, end);
  nodes_[index].first = second;
  return index;
}

}  // namespace tessera
