// Builds light trees: binary ones by a surface area and orientation heuristic, then collapsed to four
// children per node.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/light/light_tree.h"

namespace tessera {

struct BuiltLightTree {
  std::vector<LightTreeNode> nodes;  // parents before children; empty if no light has strength
};

BuiltLightTree BuildLightTree(std::span<const LightBounds> bounds, std::span<const uint32_t> lights);

}  // namespace tessera
