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

// A leaf's primitives are either triangles, no more than a block holds, or others, no more than a leaf may
// have. Node 0 is the root. The nodes of a tree over n primitives are somewhere among 2 n; the others are
// not initialised.
std::unique_ptr<BinaryNode[]> BuildBinaryTree(std::span<BoxedPrimitive> primitives, int threads);

}  // namespace tessera
