// Rays against Geometry by our own intersection tests: through a tree of boxes ("bvh"), or one primitive
// after the other ("list"). Both find the same hits, bit for bit.
#pragma once

#include <memory>

#include "renderer/accelerator/accelerator.h"

namespace tessera {

enum class SearchMethod { kTree, kList };

// `build_threads` does not change any result.
Result<std::unique_ptr<Accelerator>> MakeOwnAccelerator(SearchMethod method, const Geometry& geometry,
                                                        const TextureTable& textures, int build_threads);

}  // namespace tessera
