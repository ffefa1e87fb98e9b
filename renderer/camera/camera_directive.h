// A Camera directive while a kind of camera reads its parameters.
#pragma once

#include "renderer/description/diagnostics.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/math/transform.h"

namespace tessera {

class ImageCache;

// What cameras know of the film.
struct CameraFilm {
  int width, height;       // of the whole picture, pixels
  float diagonal_mm = 35;  // of the sensor
};

struct CameraDirective {
  ParameterReader& reader;
  CameraFilm film;
  ImageCache& images;  // and the files of the scene
  Diagnostics& diagnostics;
};

// A ray in camera space: x to the right, y up, z into the picture.
struct CameraRay {
  Point3 o;
  Vec3 d;  // unit
  // What the radiance along the ray counts for; 0 if no light reaches the film this way.
  float weight = 1;
};

// The part of the image plane that the film covers: x0 at its left edge, y0 at its lower edge.
struct ScreenWindow {
  float x0, x1, y0, y1;
};
// Reads "frameaspectratio" and "screenwindow".
ScreenWindow ReadScreenWindow(const CameraDirective& directive);

// Maps the image plane to pixels. A window with x0 > x1 or y0 > y1 mirrors the picture.
Transform RasterFromScreen(const ScreenWindow& window, const CameraFilm& film);

}  // namespace tessera
