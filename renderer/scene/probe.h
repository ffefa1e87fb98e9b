// The probe unit: a small picture of everything that there is. A worker that computes it with other bits than
// its release does (another processor, compiler or library) would spoil every picture it has a part in.
#pragma once

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// Renders built-in scenes that together touch every integrator, sampler, filter, accelerator, light sampler,
// light, shape, material, texture and medium, and gives the digest of their sums; well below a second on one
// thread. Reads no file. An error only if the renderer cannot read its own scenes.
Result<Digest> RenderProbe();

}  // namespace tessera
