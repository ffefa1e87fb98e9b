// The probe unit: small pictures of everything that can be rendered. A worker whose bits differ from those of
// its release (another processor, compiler or library) would corrupt every picture it contributes to.
#pragma once

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// Renders built-in scenes that together touch every integrator, sampler, filter, accelerator, light sampler,
// light, shape, material, texture and medium, and returns the digest of their sums; well below a second on
// one thread, less on up to seven. Reads no file. An error only if the renderer cannot read its own scenes.
Result<Digest> RenderProbe(int threads = 1);

}  // namespace tessera
