// Walks a tree of boxes from near to far.
#pragma once

#include <immintrin.h>

#include <bit>
#include <utility>

#include "renderer/accelerator/bvh_builder.h"
#include "renderer/accelerator/search_space.h"
#include "renderer/accelerator/traced_ray.h"

namespace tessera {

// The ray's side of the slab test, eight copies of each number.
struct SlabRay {
  explicit SlabRay(const TracedRay& ray) {
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      inverse[axis] = _mm256_set1_ps(ray.inverse[axis]);
      near_shift[axis] = _mm256_set1_ps(ray.near_shift[axis]);
      far_shift[axis] = _mm256_set1_ps(ray.far_shift[axis]);
      near_plane[axis] = 2 * axis + ray.is_negative[axis];
    }
  }

  // The children whose boxes the ray enters before t_max, one bit each, and where. See TracedRay::Enters.
  unsigned Enters(const BvhNode& node, float t_max, float entry[BvhNode::kChildren]) const {
    __m256 enter = _mm256_setzero_ps(), leave = _mm256_set1_ps(t_max);
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const __m256 near_t = _mm256_load_ps(node.planes[near_plane[axis]]);
      const __m256 far_t = _mm256_load_ps(node.planes[near_plane[axis] ^ 1]);
      enter = _mm256_max_ps(enter, _mm256_fmsub_ps(near_t, inverse[axis], near_shift[axis]));
      leave = _mm256_min_ps(leave, _mm256_fmsub_ps(far_t, inverse[axis], far_shift[axis]));
    }
    _mm256_store_ps(entry, enter);
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(enter, leave, _CMP_LE_OQ)));
  }

  __m256 inverse[3], near_shift[3], far_shift[3];
  int near_plane[3];
};

// What is still to be visited.
struct BvhStack {
  struct Entry {
    uint32_t child;
    float t;  // where the ray enters its box
  };
  static constexpr int kSize = kBvhDepthMax * (BvhNode::kChildren - 1) + 1;

  void Push(uint32_t child, float t) { entries[size++] = {child, t}; }
  // Sorts the entries from `first` on: the nearest comes out first.
  void SortFrom(int first) {
    for (int i = first + 1; i < size; ++i) {
      const Entry entry = entries[i];
      int j = i;
      for (; j > first && entries[j - 1].t < entry.t; --j) entries[j] = entries[j - 1];
      entries[j] = entry;
    }
  }

  Entry entries[kSize];
  int size = 0;
};

// Returns the child to visit next, of those that were entered (at least one), and pushes the others.
template <bool kSorted>
uint32_t ChooseChild(const BvhNode& node, unsigned entered, const float entry[BvhNode::kChildren],
                     BvhStack* stack) {
  int i = std::countr_zero(entered);
  entered &= entered - 1;
  if (entered == 0) return node.child[i];
  int j = std::countr_zero(entered);
  entered &= entered - 1;
  if (entered == 0) {
    if (entry[j] < entry[i]) std::swap(i, j);
    stack->Push(node.child[j], entry[j]);
    return node.child[i];
  }
  const int first = stack->size;
  stack->Push(node.child[i], entry[i]);
  stack->Push(node.child[j], entry[j]);
  for (; entered != 0; entered &= entered - 1) {
    i = std::countr_zero(entered);
    stack->Push(node.child[i], entry[i]);
  }
  if (kSorted) stack->SortFrom(first);
  return stack->entries[--stack->size].child;
}

// Calls visit_leaf(child), until it returns true, for the leaves that the ray enters before limit(), which
// may decrease.
template <bool kSorted, typename Limit, typename VisitLeaf>
void TraverseBvh(const SearchSpace& space, const TracedRay& ray, const Limit& limit,
                 const VisitLeaf& visit_leaf) {
  const SlabRay slabs(ray);
  const BvhNode* const nodes = space.nodes.data();
  BvhStack stack;
  stack.Push(0, 0);
  while (stack.size > 0) {
    const BvhStack::Entry top = stack.entries[--stack.size];
    if (top.t > limit()) continue;
    uint32_t child = top.child;
    bool is_lost = false;
    while (!(child & BvhNode::kLeaf)) {
      const BvhNode& node = nodes[child];
      alignas(32) float entry[BvhNode::kChildren];
      const unsigned entered = slabs.Enters(node, limit(), entry);
      is_lost = entered == 0;
      if (is_lost) break;
      child = ChooseChild<kSorted>(node, entered, entry, &stack);
    }
    if (!is_lost && visit_leaf(child)) return;
  }
}

}  // namespace tessera
