// Which scene or sequence to render, and how.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/frame_range.h"
#include "renderer/scene/scene.h"

namespace tessera {

constexpr double kFramesPerSecondDefault = 24;  // of films

struct SceneOptions {
  // Of the scene file; of a sequence perhaps a pattern (frame_name.h). "-" is standard input.
  std::string path;
  std::optional<FrameRange> frames;      // of a sequence
  double fps = kFramesPerSecondDefault;  // frames of one animated scene in a second of its time
  RenderOptions render;
  std::optional<uint64_t> scene_memory;  // bytes that loading one scene may take; default: see LimitsOf
};

}  // namespace tessera
