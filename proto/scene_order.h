// A scene of which a job is to be made by a worker, for clients that cannot read scenes.
#pragma once

#include <optional>
#include <string>

#include "proto/frame_range.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

constexpr double kOrderedRateMin = 1e-3, kOrderedRateMax = 1e6;  // frames per second

struct SceneOrder {
  Digest package;  // of the manifest of its scene package
  // In the package. For frames in files of their own, a pattern (FrameName).
  std::string scene_file;
  std::string options;               // EncodeRenderOptions, without what depends on the frame
  std::optional<FrameRange> frames;  // of a sequence
  double frames_per_second = 24;     // of an animated scene
  bool operator==(const SceneOrder&) const = default;
};

// The error names the member that is beyond its limit.
Result<void> CheckSceneOrder(const SceneOrder& order);

// What a worker is to prepare.
struct PreparationRequest {
  Digest key;  // PreparationKey
  SceneOrder scene;
  bool operator==(const PreparationRequest&) const = default;
};

}  // namespace tessera
