// The camera "spherical": the whole sphere of directions about a point, with +y at the top.
#pragma once

#include "renderer/camera/camera_directive.h"

namespace tessera {

class SphericalCamera {
 public:
  static SphericalCamera Read(const CameraDirective& directive);

  bool has_lens() const { return false; }
  CameraRay GenerateRay(Point2 film, Point2 u_lens) const;

 private:
  enum class Mapping {
    kEqualArea,        // octahedral: see renderer/math/equal_area.h, with y and z swapped
    kEquirectangular,  // columns of equal azimuth, rows of equal polar angle from +y
  };

  Mapping mapping_ = Mapping::kEqualArea;
  float width_ = 1, height_ = 1;  // pixels
};

}  // namespace tessera
