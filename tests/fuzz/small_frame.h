// A frame whose channels are of all types and rules, as the targets and their seeds use it.
#pragma once

#include "renderer/film/frame_spec.h"

namespace tessera {

inline FrameSpec SmallFrame() {
  FrameSpec frame;
  frame.width = frame.height = 4;
  frame.crop = {0, 0, 4, 4};
  frame.tile_size = 2;
  frame.samples_per_pixel = 8;
  AddChannel(frame.channels, SamplesChannel(true));
  AddChannel(frame.channels, {"Z", ChannelType::kDepth, MergeRule::kNearest});
  AddChannel(frame.channels, {"objects", ChannelType::kIds, MergeRule::kIdWeights});
  return frame;
}

}  // namespace tessera
