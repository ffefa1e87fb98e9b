// Renders a whole frame in this process: the reference and baseline for farms.
#pragma once

#include <functional>
#include <stop_token>

#include "client/progress_line.h"
#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Takes what is merged at this moment.
using TakeSnapshot = std::function<FrameSnapshot()>;

struct InProcessOptions {
  PixelBounds first;  // tiles that it overlaps are rendered before all others
  // Called several times a second, on the thread that renders: whoever shows the picture meanwhile may take
  // it.
  std::function<void(const TakeSnapshot&)> offer;
};

// Renders every sample of the frame on `threads` threads. `spec` is the scene's, possibly with more
// attributes. `report` is called on the calling thread, several times a second. Tiles that `first` overlaps
// are rendered before all others. The picture is bit-identical to that of any other way to render the frame.
// Returns kInterrupted if a stop is requested first, and an error if not all threads can be started or memory
// runs out.
Result<FramePicture> RenderInProcess(const Scene& scene, const FrameSpec& spec, int threads,
                                     std::stop_token stop, const std::function<void(const Progress&)>& report,
                                     const InProcessOptions& options = {});

}  // namespace tessera
