// Light that denoising takes from a picture.
#pragma once

#include <stop_token>
#include <vector>

#include "renderer/denoise/input_layers.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/result.h"

namespace tessera {

// Gives back the light that `colors` (three values of the colour of each pixel, then three of each group)
// lost to the picture: what darkened fireflies carried, and what weights lose that take the rare bright
// values of skewed noise for something else. It is returned where it was lost, to all pixels in a radius of
// some 16 pixels in proportion to their light, whatever its colour, as far as the difference exceeds the
// noise of the picture there. Errors as those of ForEachItem.
Result<void> ReturnLostLight(const LoadedPicture& picture, const InputLayers& layers, int threads,
                             const std::stop_token& stop, std::vector<float>& colors);

}  // namespace tessera
