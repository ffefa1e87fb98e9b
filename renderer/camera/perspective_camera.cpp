#include "renderer/camera/perspective_camera.h"

#include "renderer/math/sampling.h"

namespace tessera {
namespace {

constexpr float kNearPlane = 0.01f, kFarPlane = 1000;  // of the projection alone: nothing is clipped

// The window lies at distance 1 / tan(fov / 2).
Transform CameraFromRaster(float fov, const ScreenWindow& window, int width, int height) {
  const Transform raster_from_ndc = Scale(static_cast<float>(width), static_cast<float>(-height), 1);
  const Transform ndc_from_screen = Scale(1 / (window.x1 - window.x0), 1 / (window.y1 - window.y0), 1) *
                                    Translate({-window.x0, -window.y1, 0});
  const Transform screen_from_camera = Perspective(fov, kNearPlane, kFarPlane);
  return (raster_from_ndc * ndc_from_screen * screen_from_camera).Inverse();
}

}  // namespace

PerspectiveCamera PerspectiveCamera::Read(const CameraDirective& directive) {
  ParameterReader& reader = directive.reader;
  PerspectiveCamera camera;
  camera.lens_radius_ = reader.Float("lensradius", 0);
  camera.focal_distance_ = reader.Float("focaldistance", 1e6f);
  const float fov = reader.Float("fov", 90);
  const ScreenWindow window = ReadScreenWindow(directive);
  if (!(fov > 0 && fov < 180)) reader.FailAt("fov", "fov must lie between 0 and 180 degrees");
  if (camera.lens_radius_ < 0) reader.FailAt("lensradius", "lensradius must not be negative");
  if (!(camera.focal_distance_ > 0)) reader.FailAt("focaldistance", "focaldistance must be above 0");
  if (!reader.failed()) {
    camera.camera_from_raster_ = CameraFromRaster(fov, window, directive.width, directive.height);
  }
  return camera;
}

CameraRay PerspectiveCamera::GenerateRay(Point2 film, Point2 u_lens) const {
  const Point3 on_film = camera_from_raster_.ToPoint({film.x, film.y, 0});
  const Vec3 d = Normalize(on_film);
  if (!(lens_radius_ > 0)) return {{0, 0, 0}, d};
  const Point2 lens = SampleUniformDiskConcentric(u_lens) * lens_radius_;
  const Point3 focus = d * (focal_distance_ / d.z);
  const Point3 o{lens.x, lens.y, 0};
  return {o, Normalize(focus - o)};
}

}  // namespace tessera
