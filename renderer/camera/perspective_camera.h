// The camera "perspective", with a thin lens.
#pragma once

#include "renderer/camera/camera_directive.h"
#include "renderer/math/transform.h"

namespace tessera {

class PerspectiveCamera {
 public:
  static PerspectiveCamera Read(const CameraDirective& directive);

  bool has_lens() const { return lens_radius_ > 0; }
  CameraRay GenerateRay(Point2 film, Point2 u_lens) const;

 private:
  Transform camera_from_raster_;
  float lens_radius_ = 0, focal_distance_ = 1e6f;  // scene units
};

}  // namespace tessera
