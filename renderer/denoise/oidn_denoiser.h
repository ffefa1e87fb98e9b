// Denoising with Open Image Denoise.
#pragma once

#include <stop_token>
#include <string>

#include "renderer/denoise/denoised_picture.h"
#include "renderer/denoise/input_layers.h"
#include "renderer/denoise/oidn_library.h"
#include "renderer/film/picture_file.h"

namespace tessera {

// As Denoise with Denoiser::kOidn. May throw std::bad_alloc. The error names the picture `name`, and is
// kFailed if the library is not installed or fails.
Result<DenoisedColors> DenoiseWithOidn(const LoadedPicture& picture, const InputLayers& layers,
                                       const std::string& name, int threads, const std::stop_token& stop);
// The same with this library.
Result<DenoisedColors> DenoiseWithOidn(const oidn::Library& library, const LoadedPicture& picture,
                                       const InputLayers& layers, const std::string& name, int threads,
                                       const std::stop_token& stop);

}  // namespace tessera
