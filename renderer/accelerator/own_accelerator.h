// Rays against Geometry by our own intersection tests: "bvh" searches a tree of boxes, "list" tries one
// primitive after the other. Both find the same hits, bit for bit.
#pragma once

#include <memory>

#include "renderer/accelerator/accelerator.h"

namespace tessera {

Result<std::unique_ptr<Accelerator>> MakeBvhAccelerator(const Geometry& geometry,
                                                        const TextureTable& textures, int build_threads);
Result<std::unique_ptr<Accelerator>> MakeListAccelerator(const Geometry& geometry,
                                                         const TextureTable& textures, int build_threads);

}  // namespace tessera
