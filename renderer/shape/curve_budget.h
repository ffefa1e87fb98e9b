// Bounds the pieces into which the curves of a scene are split: their number is that of the segments times
// 2^splitdepth, so that a small file could ask for more than any machine holds.
#pragma once

#include <optional>

#include "renderer/shape/geometry.h"

namespace tessera {

// Pieces of all curves, each of which takes some 50 bytes of an accelerator: as many as the default depth
// makes, but this many in any case. Deeper splits of more curves than that gain nothing: the boxes of their
// pieces are small already.
constexpr uint64_t kCurvePiecesFloor = uint64_t{1} << 22;

// Lowers the depth of all curves that are split deeper than the result, the largest depth for which the
// pieces are few enough. Returns nullopt, and changes nothing, if they are. Does not change the picture:
// rays are intersected with the curves themselves. No curve may emit yet.
std::optional<int> LimitCurvePieces(Geometry& geometry);

}  // namespace tessera
