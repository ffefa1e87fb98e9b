// The ideal lens of cameras that only know the plane of focus.
#pragma once

#include "renderer/camera/camera_directive.h"
#include "renderer/math/sampling.h"

namespace tessera {

struct ThinLens {
  float radius = 0, focal_distance = 1e6f;  // scene units; a radius of 0 is a pinhole

  // Reads "lensradius" and "focaldistance".
  static ThinLens Read(ParameterReader& reader, float default_focal_distance);

  bool is_pinhole() const { return !(radius > 0); }
  // The ray from the lens through a point in focus.
  CameraRay RayThrough(Point3 focus, Point2 u_lens) const {
    const Point2 lens = SampleUniformDiskConcentric(u_lens) * radius;
    const Point3 o{lens.x, lens.y, 0};
    return {o, Normalize(focus - o)};
  }
};

}  // namespace tessera
