// Denoises the frames of a sequence with their neighbours, so that what is left of the noise flickers less.
//
// Each frame is denoised alone first. Then each pixel is blended with what the frames before and after show
// of the same point, which the layer "motion" tells (as the temporal filters of Schied et al.,
// "Spatiotemporal Variance-Guided Filtering", HPG 2017): colours divided by the albedo, of points that agree
// in normal and depth, as far as they differ by no more than their noise. So shadows and reflections that
// move are not dragged along, and textures stay sharp.
#pragma once

#include <array>
#include <optional>
#include <stop_token>
#include <string>

#include "renderer/denoise/denoised_picture.h"
#include "renderer/denoise/input_layers.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/result.h"

namespace tessera {

// A frame that was denoised alone.
struct DenoisedFrame {
  LoadedPicture picture;  // as it was rendered
  InputLayers layers;
  std::optional<std::array<size_t, 2>> motion;  // the channels of its vectors
  DenoisedColors colors;
};

// Arguments and errors are those of Denoise.
Result<DenoisedFrame> DenoiseAlone(LoadedPicture picture, const std::string& name, int threads,
                                   const std::stop_token& stop, Denoiser denoiser);

// What Denoise makes of the frame, blended with its neighbours, which may be null. A neighbour of another
// size, without depths or without the vectors that lead to it is left out. Values are the same for any number
// of threads.
Result<LoadedPicture> BlendFrames(const DenoisedFrame* before, const DenoisedFrame& frame,
                                  const DenoisedFrame* after, int threads, const std::stop_token& stop);

}  // namespace tessera
