// Builds trees of boxes by the surface area heuristic (Wald 2007, "On fast Construction of SAH-based Bounding
// Volume Hierarchies"): a binary tree, split at the best of 16 bins on each axis, whose nodes are
// then merged until each has eight children (Wald, Benthin, Boulos 2008, "Getting Rid of Packets").
#pragma once

#include "renderer/accelerator/search_space.h"
#include "renderer/util/result.h"

namespace tessera {

// No path from the root of a tree to a leaf has more nodes.
constexpr int kBvhDepthMax = 96;

// Sorts `primitives` and builds the space over them. Subtrees are built by up to `threads` threads (at least
// 1); the result does not depend on their number.
Result<SearchSpace> BuildBvhSpace(std::span<const Shape> shapes, std::vector<BoxedPrimitive> primitives,
                                  int threads);

}  // namespace tessera
