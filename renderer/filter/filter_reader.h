// What all kinds of filters share.
#pragma once

#include "renderer/description/parameter_reader.h"
#include "renderer/math/vec.h"

namespace tessera {

struct FilterSample {
  Vec2 offset;  // from the pixel's centre, in pixels
  float weight = 1;
};

// The parameters "xradius" and "yradius", in pixels.
Vec2 ReadRadius(ParameterReader& reader, float default_radius);

}  // namespace tessera
