// The primitives of one space, the scene's or a group's, packed for our own intersection tests, and the tree
// over them if there is one.
#pragma once

#include <span>
#include <vector>

#include "renderer/accelerator/triangle_block.h"
#include "renderer/shape/geometry.h"

namespace tessera {

enum class PrimitiveKind : uint8_t { kTriangle, kPatchHalf0, kPatchHalf1, kOther, kInstance };
inline bool IsTriangle(PrimitiveKind kind) {
  return kind <= PrimitiveKind::kPatchHalf1;
}

// Identifies a primitive. An instance is a primitive of the space it is placed in.
struct PrimitiveName {
  uint32_t shape = 0;  // of an instance: index in Geometry::instances
  uint32_t primitive = 0;
  PrimitiveKind kind = PrimitiveKind::kTriangle;
  bool has_alpha = false;
  bool stops_shadow_rays = true;
};

// A primitive that is not made of triangles.
struct OtherPrimitive {
  Bounds3 bounds;
  PrimitiveName name;
};

// Eight children, whose boxes are tested together.
struct alignas(64) BvhNode {
  static constexpr int kChildren = 8;
  // A child is the index of a node; or, with kLeaf, that of a block; or, with kLeaf and kOthers, a count and
  // the index of the first of some other primitives.
  static constexpr uint32_t kLeaf = 1u << 31, kOthers = 1u << 30;
  static constexpr int kCountShift = 28;
  static constexpr uint32_t kOthersPerLeafMax = 3;
  static constexpr uint32_t kOthersMax = 1u << kCountShift;

  float planes[6][kChildren];  // min x, max x, min y, ...; an unused child's box is empty
  uint32_t child[kChildren];
};

// Immutable once built.
struct SearchSpace {
  Bounds3 bounds;
  std::vector<TriangleBlock> blocks;
  std::vector<OtherPrimitive> others;
  std::vector<BvhNode> nodes;  // root first; none: all primitives are tried in order
  // Expected number of boxes of children, blocks and other primitives that a random line through the bounds
  // is tested against: each is met with the probability that is its parent's share of the area.
  double cost = 0;

  bool empty() const { return blocks.empty() && others.empty(); }
  uint64_t bytes() const {
    return blocks.size() * sizeof(TriangleBlock) + others.size() * sizeof(OtherPrimitive) +
           nodes.size() * sizeof(BvhNode);
  }
};

// A primitive with its box, to be sorted into a tree.
struct BoxedPrimitive {
  Bounds3 bounds;
  PrimitiveName name;
};

// All primitives of `shapes` that can be hit, in order. Those without finite bounds are left out: no ray
// meets them.
std::vector<BoxedPrimitive> CollectPrimitives(std::span<const Shape> shapes);

// Packs triangles (at most TriangleBlock::kLanes) of `shapes`.
TriangleBlock MakeBlock(std::span<const Shape> shapes, std::span<const BoxedPrimitive> triangles);

// Builds a space without a tree, in the order given.
SearchSpace MakeListSpace(std::span<const Shape> shapes, std::span<const BoxedPrimitive> primitives);

}  // namespace tessera
