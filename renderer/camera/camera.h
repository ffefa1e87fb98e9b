// Cameras: from a place on the film to a ray.
#pragma once

#include "renderer/description/scene_description.h"
#include "renderer/math/ray.h"
#include "renderer/math/transform.h"
#include "renderer/util/result.h"

namespace tessera {

// Change of a surface point per pixel of the image.
struct Footprint {
  Vec3 dpdx, dpdy;
};

// Rendering space has the axes of world space and its origin at the camera (pbrt's "cameraworld"):
// coordinates near the camera keep the most digits. A perspective camera with a thin lens. Immutable.
class Camera {
 public:
  // Reads a Camera directive for a picture of width x height pixels. The camera must not move.
  static Result<Camera> Read(const Entity& entity, const TransformPair& camera_from_world, int width,
                             int height);

  const Transform& render_from_world() const { return render_from_world_; }
  bool has_lens() const { return lens_radius_ > 0; }
  // Seconds that the shutter is open.
  float exposure_time() const { return shutter_close_ - shutter_open_; }

  // The ray through the film at `film` (pixels from the upper left corner) and the lens at `u_lens` in [0,
  // 1)^2. `u_time` in [0, 1) chooses the time. d has unit length.
  Ray GenerateRay(Point2 film, Point2 u_lens, float u_time) const;

  // The footprint of a pixel at a point as if the camera saw it directly, times `scale`: an approximation
  // that serves points seen through reflections as well.
  Footprint ApproximateFootprint(Point3 p, Normal3 n, float scale) const;

 private:
  Transform render_from_world_, render_from_camera_, camera_from_raster_;
  float lens_radius_ = 0, focal_distance_ = 1e6f;  // scene units
  float shutter_open_ = 0, shutter_close_ = 1;     // seconds
  float spread_x_ = 0, spread_y_ = 0;              // smallest change of a unit ray direction per pixel
};

}  // namespace tessera
