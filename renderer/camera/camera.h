// Cameras: from a place on the film to a ray.
//
// To add a kind of camera, write a class that satisfies CameraKind in files of its own, append it to
// AnyCamera and give it a row in camera.cpp.
#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <variant>

#include "renderer/camera/camera_directive.h"
#include "renderer/camera/orthographic_camera.h"
#include "renderer/camera/perspective_camera.h"
#include "renderer/camera/realistic_camera.h"
#include "renderer/camera/spherical_camera.h"
#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"
#include "renderer/math/moving_transform.h"
#include "renderer/math/ray.h"
#include "renderer/math/transform.h"
#include "renderer/util/dispatch.h"
#include "renderer/util/result.h"

namespace tessera {

// Change of a surface point per pixel of the image.
struct Footprint {
  Vec3 dpdx, dpdy;
};

// What kinds of cameras differ in: how rays leave the film, in camera space. Small values.
template <typename T>
concept CameraKind = requires(const T& camera, const CameraDirective& directive, Point2 film, Point2 u_lens) {
  // Reports errors to the reader.
  { T::Read(directive) } -> std::same_as<T>;
  // Whether rays depend on u_lens.
  { camera.has_lens() } -> std::same_as<bool>;
  // See Camera::GenerateRay.
  { camera.GenerateRay(film, u_lens) } -> std::same_as<CameraRay>;
};

template <CameraKind... Kinds>
using CameraOf = std::variant<Kinds...>;
using AnyCamera = CameraOf<PerspectiveCamera, OrthographicCamera, SphericalCamera, RealisticCamera>;

// A ray of light that reaches the film.
struct CameraSample {
  Ray ray;           // d has unit length
  float weight = 1;  // of the radiance along the ray; 0 if no light reaches the film this way
};

// Rendering space has the axes of world space and its origin at the camera (pbrt's "cameraworld"):
// coordinates near the camera keep the most digits. Of a camera that moves, the origin is where it is in the
// middle of the shutter. Immutable.
class Camera {
 public:
  // Reads a Camera directive, and the files that it names from those of `images`.
  static Result<Camera> Read(const Entity& entity, const AnimatedTransform& camera_from_world,
                             const CameraFilm& film, ImageCache& images, Diagnostics& diagnostics);

  const Transform& render_from_world() const { return render_from_world_; }
  bool has_lens() const {
    return Dispatch(kind_, [](const auto& kind) { return kind.has_lens(); });
  }
  Transform RenderFromCamera(float time_s) const {
    return motion_ == nullptr ? render_from_camera_ : motion_->At(time_s);
  }
  // From camera space to pixels from the upper left corner; nullopt if the kind of camera is no projection.
  std::optional<Transform> raster_from_camera() const {
    return Dispatch(kind_, [](const auto& kind) -> std::optional<Transform> {
      if constexpr (requires { kind.raster_from_camera(); }) return kind.raster_from_camera();
      return std::nullopt;
    });
  }
  // Time for which the shutter is open, seconds.
  float exposure_time() const { return shutter_close_ - shutter_open_; }
  // Seconds: the times of all rays lie in between.
  float shutter_open() const { return shutter_open_; }
  float shutter_close() const { return shutter_close_; }
  bool moves() const { return motion_ != nullptr; }

  // The ray through the film at `film` (pixels from the upper left corner) and the lens at `u_lens` in [0,
  // 1)^2. `u_time` in [0, 1) chooses the time.
  CameraSample GenerateRay(Point2 film, Point2 u_lens, float u_time) const;
  // The same at a time, in seconds.
  CameraSample GenerateRayAt(Point2 film, Point2 u_lens, float time_s) const;

  // The footprint of a pixel at a point as if the camera saw it directly, times `scale`: an approximation
  // that serves points seen through reflections as well.
  Footprint ApproximateFootprint(Point3 p, Normal3 n, float scale) const;

 private:
  // How far the ray moves over a distance of one pixel.
  struct Spread {
    float direction = 0;  // change of the unit direction
    float origin = 0;     // scene units
  };
  Spread MeasureSpread(const CameraFilm& film, Vec2 pixel) const;
  void Place(const AnimatedTransform& camera_from_world);

  AnyCamera kind_;
  Transform render_from_world_;
  Transform render_from_camera_;  // in the middle of the shutter
  std::shared_ptr<const MovingTransform>
      motion_;                                  // render_from_camera_ at other times; null: it stands still
  float shutter_open_ = 0, shutter_close_ = 1;  // seconds
  Vec3 forward_{0, 0, 1};                       // in rendering space
  Spread spread_x_, spread_y_;                  // the smallest of the film
};

KindList CameraKinds();

}  // namespace tessera
