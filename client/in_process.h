// Renders a whole frame in this process: the oracle for the farm, and the baseline.
#pragma once

#include <functional>
#include <stop_token>

#include "client/progress_line.h"
#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Renders every sample of the frame on `threads` threads; `spec` is the scene's, perhaps with more
// attributes. `report` is called on the calling thread, a few times a second. The picture has the bits of
// every other way to render the frame. kInterrupted if `stop` was requested first.
Result<FramePicture> RenderInProcess(const Scene& scene, const FrameSpec& spec, int threads,
                                     std::stop_token stop,
                                     const std::function<void(const Progress&)>& report);

}  // namespace tessera
