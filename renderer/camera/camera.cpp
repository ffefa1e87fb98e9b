#include "renderer/camera/camera.h"

#include <limits>

namespace tessera {
namespace {

using CameraReader = AnyCamera (*)(const CameraDirective& directive);

template <CameraKind T>
AnyCamera Read(const CameraDirective& directive) {
  return T::Read(directive);
}

constexpr Kind<CameraReader> kCameras[] = {
    {"perspective", Support::kSupported, Read<PerspectiveCamera>},
    {"orthographic", Support::kNotSupported},
    {"realistic", Support::kNotSupported},
    {"spherical", Support::kNotSupported},
};
constexpr KindTable<CameraReader> kCameraTable("camera", kCameras);

}  // namespace

Result<Camera> Camera::Read(const Entity& entity, const Transform& camera_from_world, int width, int height) {
  const Kind<CameraReader>* kind = kCameraTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kCameraTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  Camera camera;
  camera.shutter_open_ = reader.Float("shutteropen", 0);
  camera.shutter_close_ = reader.Float("shutterclose", 1);
  if (!(camera.shutter_close_ > camera.shutter_open_)) {
    reader.FailAt("shutterclose", "shutterclose must be later than shutteropen");
  }
  camera.kind_ = kind->reader({reader, width, height});
  if (Result<void> done = reader.Finish(); !done) return done.error();

  const Transform world_from_camera = camera_from_world.Inverse();
  const Point3 eye = world_from_camera.ToPoint({0, 0, 0});
  camera.render_from_world_ = Translate(-eye);
  camera.render_from_camera_ = camera.render_from_world_ * world_from_camera;
  camera.MeasureSpread(width, height);
  return camera;
}

void Camera::MeasureSpread(int width, int height) {
  constexpr int kPlaces = 64;  // along the diagonal of the film
  spread_x_ = spread_y_ = std::numeric_limits<float>::max();
  for (int i = 0; i < kPlaces; ++i) {
    const Point2 film{(i + 0.5f) / kPlaces * static_cast<float>(width),
                      (i + 0.5f) / kPlaces * static_cast<float>(height)};
    const Vec3 d = GenerateRay(film, {0.5f, 0.5f}, 0).d;
    const Vec3 right = GenerateRay({film.x + 1, film.y}, {0.5f, 0.5f}, 0).d;
    const Vec3 down = GenerateRay({film.x, film.y + 1}, {0.5f, 0.5f}, 0).d;
    spread_x_ = std::min(spread_x_, Length(right - d));
    spread_y_ = std::min(spread_y_, Length(down - d));
  }
}

Ray Camera::GenerateRay(Point2 film, Point2 u_lens, float u_time) const {
  const CameraRay in_camera_space =
      Dispatch(kind_, [=](const auto& kind) { return kind.GenerateRay(film, u_lens); });
  Ray ray;
  ray.o = render_from_camera_.ToPoint(in_camera_space.o);
  ray.d = Normalize(render_from_camera_.ToVector(in_camera_space.d));
  ray.time = Lerp(u_time, shutter_open_, shutter_close_);
  return ray;
}

Footprint Camera::ApproximateFootprint(Point3 p, Normal3 n, float scale) const {
  const float distance = Length(p);
  if (!(distance > 0)) return {};
  const Frame frame = Frame::FromZ(p / distance);
  const float plane = Dot(n, p);
  const Vec3 x_ray = frame.z + frame.x * spread_x_;
  const Vec3 y_ray = frame.z + frame.y * spread_y_;
  const float x_cosine = Dot(n, x_ray), y_cosine = Dot(n, y_ray);
  if (x_cosine == 0 || y_cosine == 0) return {};
  return {(x_ray * (plane / x_cosine) - p) * scale, (y_ray * (plane / y_cosine) - p) * scale};
}

KindList CameraKinds() {
  return kCameraTable.List();
}

}  // namespace tessera
