// A frame for tests of the wire.
#pragma once

#include "renderer/film/frame_spec.h"

namespace tessera {

inline FrameSpec GoodFrame() {
  FrameSpec spec;
  spec.width = 100;
  spec.height = 50;
  spec.crop = {10, 0, 90, 50};
  spec.samples_per_pixel = 12;
  spec.tile_size = 16;
  spec.exr_type = ExrType::kFloat;
  spec.SetNoiseThreshold(0.07);
  AddChannel(spec.channels, SamplesChannel(true));
  spec.denoiser = Denoiser::kRegression;
  spec.cryptomatte_levels = 5;
  spec.attributes = {{"seed", "7"}, {"scene", "x"}};
  return spec;
}

}  // namespace tessera
