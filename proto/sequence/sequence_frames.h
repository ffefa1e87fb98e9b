// The frames that are rendered of a scene or of a sequence, each with its scene file and options, and what a
// job says of them. Clients that submit jobs and workers that prepare them make the same.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/frame_range.h"
#include "proto/scene_package.h"
#include "proto/terms.h"
#include "renderer/scene/scene.h"
#include "renderer/util/result.h"

namespace tessera {

struct SequenceFrame {
  int number = 0;    // as the user counts
  std::string path;  // of its scene file
  RenderOptions options;
  // All frames come from one scene file, whose moving parts are shown at the time of the frame.
  bool is_animated = false;
};

// The frames of `range`, or the one frame of a scene. `path` is that of the scene file; for frames in files
// of their own, a pattern (FrameName). `frames_per_second` is the rate of an animated scene.
std::vector<SequenceFrame> FramesOf(const std::string& path, const RenderOptions& options,
                                    const std::optional<FrameRange>& range, double frames_per_second);

// A frame as a job has it. `scene_file` is its file in the scene package and `files` are those that it
// consists of, under the names that it uses. An error, which names the frame's path, if it cannot be denoised
// as its options demand.
Result<FrameRequest> RequestFrame(const SequenceFrame& frame, std::string scene_file, const Scene& scene,
                                  const ScenePackage& files);
// The same of another frame of the animated scene that `first` is of.
FrameRequest RequestFrameLike(const FrameRequest& first, const SequenceFrame& frame, const Scene& scene);

}  // namespace tessera
