// Rays against Geometry by Embree 3 (Wald et al. 2014).
//
// Hits must have the same bits on every machine, so: AVX2 and robust mode always; the parts of a hit
// that reach the picture are recomputed in double (hit_refinement.h), as Embree's reciprocals differ between
// makes of processors; Embree's builder orders its leaves, so the tree does not depend on the number of
// threads; and the processor's treatment of denormal numbers (FTZ, DAZ) is left at its default, although
// Embree recommends changing it, because it is a setting of each thread and would be missing on some.
#pragma once

#include <memory>

#include "renderer/accelerator/accelerator.h"

namespace tessera {

Result<std::unique_ptr<Accelerator>> MakeEmbreeAccelerator(const Geometry& geometry,
                                                           const TextureTable& textures, int build_threads);

}  // namespace tessera
