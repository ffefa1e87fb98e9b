// How many triangles a scene may have made of its meshes: `loopsubdiv` and `displacement` make any number of
// a few bytes.
#pragma once

#include <cstdint>

namespace tessera {

// By all shapes of a scene together. They take some 100 bytes each with the accelerator; more do not fit into
// memory in a useful way.
constexpr uint64_t kMadeTrianglesMax = uint64_t{1} << 26;

}  // namespace tessera
