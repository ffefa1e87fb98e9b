// The pictures of lights at infinity.
#pragma once

#include "renderer/description/parameter_reader.h"
#include "renderer/light/emission_image.h"

namespace tessera {

// The square picture of parameter `filename`, equal-area octahedral (math/equal_area.h), z up. Empty after an
// error, which the reader remembers.
RgbImage ReadEnvironmentMap(ParameterReader& reader, ImageCache& images, Diagnostics& diagnostics);

// The factor that gives the picture the illuminance of parameter `illuminance` on a plane that faces +z; 1
// without the parameter, and after an error.
float IlluminanceFactor(ParameterReader& reader, const RgbImage& image);

}  // namespace tessera
