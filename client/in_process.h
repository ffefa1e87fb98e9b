// Renders a whole frame in this process: the reference and baseline for farms.
#pragma once

#include <functional>
#include <stop_token>

#include "client/progress_line.h"
#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Renders every sample of the frame on `threads` threads. `spec` is the scene's, possibly with more
// attributes. `report` is called on the calling thread, several times a second. The picture is bit-identical
// to that of any other way to render the frame. Returns kInterrupted if a stop is
// requested first, and an error if not all threads can be started or memory runs out.
Result<FramePicture> RenderInProcess(const Scene& scene, const FrameSpec& spec, int threads,
                                     std::stop_token stop,
                                     const std::function<void(const Progress&)>& report);

}  // namespace tessera
