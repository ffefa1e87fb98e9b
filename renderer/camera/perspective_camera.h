// The camera "perspective", with a thin lens.
#pragma once

#include "renderer/camera/thin_lens.h"

namespace tessera {

class PerspectiveCamera {
 public:
  static PerspectiveCamera Read(const CameraDirective& directive);

  bool has_lens() const { return !lens_.is_pinhole(); }
  CameraRay GenerateRay(Point2 film, Point2 u_lens) const;
  // The projection: pixels from the upper left corner.
  Transform raster_from_camera() const { return camera_from_raster_.Inverse(); }

 private:
  Transform camera_from_raster_;
  ThinLens lens_;
};

}  // namespace tessera
