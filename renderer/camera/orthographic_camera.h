// The camera "orthographic": parallel rays from the screen window, which lies in the plane of the camera.
#pragma once

#include "renderer/camera/thin_lens.h"

namespace tessera {

class OrthographicCamera {
 public:
  static OrthographicCamera Read(const CameraDirective& directive);

  bool has_lens() const { return !lens_.is_pinhole(); }
  // With a lens, rays start on it and meet where the parallel ones cross the plane of focus. The lens is as
  // small as its radius, wherever the ray crosses the film, so the picture is in perspective, as pbrt's is.
  CameraRay GenerateRay(Point2 film, Point2 u_lens) const;
  // The projection: pixels from the upper left corner.
  Transform raster_from_camera() const { return camera_from_raster_.Inverse(); }

 private:
  Transform camera_from_raster_;
  ThinLens lens_;
};

}  // namespace tessera
