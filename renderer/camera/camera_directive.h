// A Camera directive while a kind of camera reads its parameters.
#pragma once

#include "renderer/description/parameter_reader.h"
#include "renderer/math/vec.h"

namespace tessera {

struct CameraDirective {
  ParameterReader& reader;
  int width, height;  // of the whole picture, pixels
};

// A ray in camera space: x to the right, y up, z into the picture.
struct CameraRay {
  Point3 o;
  Vec3 d;  // unit
};

// The part of the image plane that the film covers.
struct ScreenWindow {
  float x0, x1, y0, y1;
};
// Reads "frameaspectratio" and "screenwindow".
ScreenWindow ReadScreenWindow(const CameraDirective& directive);

}  // namespace tessera
