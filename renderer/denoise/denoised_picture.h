// What a picture becomes when its colours are denoised.
#pragma once

#include <string>
#include <vector>

#include "renderer/denoise/input_layers.h"
#include "renderer/film/picture_file.h"

namespace tessera {

// What denoising makes of a picture: for each pixel three values of the colour, then three for each group.
struct DenoisedColors {
  std::vector<float> values;
  std::string denoiser;  // that made them, with its version
};

// Brings what denoising made of a pixel into order: three values of the colour, then three for each group. A
// colour is not negative where the noisy one, in `pixel`, is not; the light of groups is not negative, and
// its sum is the colour.
void SettleColors(const float* pixel, const InputLayers& layers, float* denoised);

// The picture with the denoised values, as SettleColors left them, as R, G and B and in the layers of the
// groups. The others are kept in the layers "noisy" and "noisy_light_...". Its header names the denoiser.
LoadedPicture WithColors(const LoadedPicture& picture, const InputLayers& layers,
                         const DenoisedColors& colors);

}  // namespace tessera
