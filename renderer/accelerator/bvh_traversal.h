// Walks a tree of boxes from near to far.
#pragma once

#include <immintrin.h>

#include <bit>

#include "accelerator/bvh_builder.h"
#include "accelerator/search_space.h"
#include "accelerator/traced_ray.h"

namespace tessera {

// The ray's side of the slab test, eight copies of each number.
struct SlabRay {
  explicit SlabRay(const TracedRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      inverse[axis] = _mm256_set1_ps(ray.inverse[axis]);
      near_shift[axis] = _mm256_set1_ps(ray.near_shift[axis]);
      far_shift[axis] = _mm256_set1_ps(ray.far_shift[axis]);
      near_plane[axis] = 2 * axis + ray.is_negative[axis];
    }
  }

  // The children whose boxes the ray enters before t_max, one bit each, and where. As TracedRay::Enters.
  unsigned Enters(const BvhNode& node, float t_max, float entry[BvhNode::kChildren]) const {
    __m256 enter = _mm256_setzero_ps(), leave = _mm256_set1_ps(t_max);
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

// Calls visit_leaf(child), until it returns true, for the leaves that the ray enters before limit(), which
// may decrease.
template <bool kSorted, typename Limit, typename VisitLeaf>
void TraverseBvh(const SearchSpace& space, const TracedRay& ray, const Limit& limit,
                 const VisitLeaf& visit_leaf) {
  const SlabRay slabs(ray);
  BvhStack stack;
  stack.Push(0, 0);
  while (stack.size > 0) {
    const BvhStack::Entry entry = stack.entries[--stack.size];
    if (entry.t > limit()) continue;
    uint32_t child = entry.child;
    while (!(child & BvhNode::kLeaf)) {
      const BvhNode& node = space.nodes[child];
      alignas(32) float entries[BvhNode::kChildren];
      unsigned entered = slabs.Enters(node, limit(), entries);
      const int first = stack.size;
      for (; entered != 0; entered &= entered - 1) {
        const int i = std::countr_zero(entered);
        stack.Push(node.child[i], entries[i]);
      }
      if (stack.size == first) break;
      if (kSorted) stack.SortFrom(first);
      child = stack.entries[--stack.size].child;
    }
    if (child & BvhNode::kLeaf && visit_leaf(child)) return;
  }
}

}  // namespace tessera
