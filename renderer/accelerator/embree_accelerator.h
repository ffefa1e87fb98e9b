// Rays against Geometry by Embree 3 (Wald et al. 2014).
#pragma once

#include <memory>

#include "accelerator/accelerator.h"

namespace tessera {

// `build_threads` does not change any result.
Result<std::unique_ptr<Accelerator>> MakeEmbreeAccelerator(const Geometry& geometry,
                                                           const TextureTable& textures, int build_threads);

}  // namespace tessera
