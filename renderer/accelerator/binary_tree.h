// The binary tree that a BVH is made from.
#pragma once

#include <memory>
#include <span>

#include "renderer/accelerator/search_space.h"

namespace tessera {

struct BinaryNode {
  Bounds3 bounds;
  uint32_t begin = 0, end = 0;  // its primitives
  uint32_t right = 0;           // 0: a leaf; the left child is the next node

  bool is_leaf() const { return right == 0; }
};

// A leaf holds either triangles, at most a block of them, or other primitives, at most kOthersPerLeafMax.
// Node 0 is the root. The array has 2 n nodes for n primitives; those that the tree does not use are not
// initialised.
std::unique_ptr<BinaryNode[]> BuildBinaryTree(std::span<BoxedPrimitive> primitives, int threads);

}  // namespace tessera
