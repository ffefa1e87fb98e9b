// The files of complete frames, denoised if their frame asks for it. What renders in one process and the
// coordinator of a farm both make them here, so they have the same bytes.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "renderer/film/frame_spec.h"
#include "renderer/film/merger.h"
#include "renderer/util/result.h"

namespace tessera {

// Fails if the frame asks for a denoiser that cannot work: it names the layers that the frame lacks, or too
// few samples. The error starts with `name`.
Result<void> CheckDenoiser(const FrameSpec& spec, const std::string& name);

// The layers of the picture that the frame has only because it is denoised.
std::vector<std::string> LayersOfDenoising(const FrameSpec& spec);

// Fails if this machine lacks what the denoiser needs.
Result<void> CheckInstalled(Denoiser denoiser);

struct EncodedPicture {
  std::string exr;             // the bytes of the file
  std::string denoise_failed;  // the value of kDenoiseFailedAttribute; empty: there is none
};

// `threads` and `stop` are those of Denoise. If the picture cannot be denoised, for want of memory, it is
// noisy and its header has kDenoiseFailedAttribute. Fails if the picture cannot be encoded, or if a stop is
// requested before it is denoised.
Result<EncodedPicture> EncodeFinished(const FrameSpec& spec, FramePicture picture, int threads,
                                      const std::stop_token& stop);

}  // namespace tessera
