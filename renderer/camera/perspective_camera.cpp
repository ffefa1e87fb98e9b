#include "renderer/camera/perspective_camera.h"

namespace tessera {
namespace {

constexpr float kNearPlane = 0.01f, kFarPlane = 1000;  // of the projection alone: nothing is clipped
constexpr float kFocalDistanceDefault = 1e6f;

}  // namespace

PerspectiveCamera PerspectiveCamera::Read(const CameraDirective& directive) {
  ParameterReader& reader = directive.reader;
  PerspectiveCamera camera;
  camera.lens_ = ThinLens::Read(reader, kFocalDistanceDefault);
  const float fov = reader.Float("fov", 90);
  const ScreenWindow window = ReadScreenWindow(directive);
  if (!(fov > 0 && fov < 180)) reader.FailAt("fov", "fov must lie between 0 and 180 degrees");
  if (!reader.failed()) {
    // The window lies at distance 1 / tan(fov / 2).
    const Transform screen_from_camera = Perspective(fov, kNearPlane, kFarPlane);
    camera.camera_from_raster_ = (RasterFromScreen(window, directive.film) * screen_from_camera).Inverse();
  }
  return camera;
}

CameraRay PerspectiveCamera::GenerateRay(Point2 film, Point2 u_lens) const {
  const Point3 on_film = camera_from_raster_.ToPoint({film.x, film.y, 0});
  const Vec3 d = Normalize(on_film);
  if (lens_.is_pinhole()) return {{0, 0, 0}, d};
  return lens_.RayThrough(d * (lens_.focal_distance / d.z), u_lens);
}

}  // namespace tessera
