#include "renderer/camera/camera.h"

#include <algorithm>
#include <cmath>
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
    {"orthographic", Support::kSupported, Read<OrthographicCamera>},
    {"spherical", Support::kSupported, Read<SphericalCamera>},
    {"realistic", Support::kSupported, Read<RealisticCamera>},
};
constexpr KindTable<CameraReader> kCameraTable("camera", kCameras);

CameraSample PlacedSample(const CameraRay& in_camera_space, const Transform& render_from_camera,
                          float time_s) {
  CameraSample sample;
  sample.ray.o = render_from_camera.ToPoint(in_camera_space.o);
  sample.ray.d = Normalize(render_from_camera.ToVector(in_camera_space.d));
  sample.ray.time = time_s;
  sample.weight = in_camera_space.weight;
  return sample;
}

}  // namespace

void Camera::Place(const AnimatedTransform& camera_from_world) {
  // The camera moves, not the world around it: the keys of its own map are those to interpolate.
  const AnimatedTransform world_from_camera = camera_from_world.Inverse();
  const double middle_s = (static_cast<double>(shutter_open_) + static_cast<double>(shutter_close_)) / 2;
  const Transform in_the_middle = world_from_camera.At(middle_s).value_or(world_from_camera.First());
  render_from_world_ = Translate(-in_the_middle.ToPoint({0, 0, 0}));
  render_from_camera_ = render_from_world_ * in_the_middle;
  if (!world_from_camera.IsAnimated()) return;
  const AnimatedTransform factors[] = {AnimatedTransform(render_from_world_), world_from_camera};
  motion_ = std::make_shared<const MovingTransform>(factors);
}

Result<Camera> Camera::Read(const Entity& entity, const AnimatedTransform& camera_from_world,
                            const CameraFilm& film, ImageCache& images, Diagnostics& diagnostics) {
  const Kind<CameraReader>* kind = kCameraTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kCameraTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  Camera camera;
  camera.shutter_open_ = reader.Float("shutteropen", 0);
  camera.shutter_close_ = reader.Float("shutterclose", 1);
  if (!(camera.shutter_close_ > camera.shutter_open_))
    reader.FailAt("shutterclose", "the shutter does not open: shutterclose must be later than shutteropen");
  if (!std::isfinite(camera.exposure_time()))
    reader.FailAt("shutterclose", "the shutter is open for too long");
  camera.kind_ = kind->reader({reader, film, images, diagnostics});
  if (Result<void> done = reader.Finish(); !done) return done.error();

  camera.Place(camera_from_world);
  camera.forward_ = Normalize(camera.render_from_camera_.ToVector({0, 0, 1}));
  camera.spread_x_ = camera.MeasureSpread(film, {1, 0});
  camera.spread_y_ = camera.MeasureSpread(film, {0, 1});
  return camera;
}

Camera::Spread Camera::MeasureSpread(const CameraFilm& film, Vec2 pixel) const {
  constexpr int kPlaces = 64;  // along the diagonal of the film
  constexpr float kUnknown = std::numeric_limits<float>::max();
  Spread spread{kUnknown, kUnknown};
  for (int i = 0; i < kPlaces; ++i) {
    const Point2 place{(i + 0.5f) / kPlaces * static_cast<float>(film.width),
                       (i + 0.5f) / kPlaces * static_cast<float>(film.height)};
    const CameraSample here = GenerateRay(place, {0.5f, 0.5f}, 0);
    const CameraSample next = GenerateRay(place + pixel, {0.5f, 0.5f}, 0);
    if (here.weight == 0 || next.weight == 0) continue;
    spread.direction = std::min(spread.direction, Length(next.ray.d - here.ray.d));
    spread.origin = std::min(spread.origin, Length(next.ray.o - here.ray.o));
  }
  return spread.direction < kUnknown ? spread : Spread{};
}

CameraSample Camera::GenerateRay(Point2 film, Point2 u_lens, float u_time) const {
  return GenerateRayAt(film, u_lens, std::min(Lerp(u_time, shutter_open_, shutter_close_), shutter_close_));
}

CameraSample Camera::GenerateRayAt(Point2 film, Point2 u_lens, float time_s) const {
  const CameraRay in_camera_space =
      Dispatch(kind_, [=](const auto& kind) { return kind.GenerateRay(film, u_lens); });
  if (motion_ == nullptr) return PlacedSample(in_camera_space, render_from_camera_, time_s);
  return PlacedSample(in_camera_space, motion_->At(time_s), time_s);
}

Footprint Camera::ApproximateFootprint(Point3 p, Normal3 n, float scale) const {
  const float distance = Length(p);
  if (!(distance > 0)) return {};
  // Rays that all have one direction reach p in it; others come about from the origin.
  const bool is_parallel = spread_x_.direction == 0 && spread_y_.direction == 0;
  const Frame frame = Frame::FromZ(is_parallel ? forward_ : p / distance);
  const Point3 origin = is_parallel ? p - frame.z * Dot(frame.z, p) : Point3{0, 0, 0};
  const float plane = Dot(n, p);
  const Vec3 x_origin = origin + frame.x * spread_x_.origin, x_ray = frame.z + frame.x * spread_x_.direction;
  const Vec3 y_origin = origin + frame.y * spread_y_.origin, y_ray = frame.z + frame.y * spread_y_.direction;
  const float x_cosine = Dot(n, x_ray), y_cosine = Dot(n, y_ray);
  if (x_cosine == 0 || y_cosine == 0) return {};
  return {(x_origin + x_ray * ((plane - Dot(n, x_origin)) / x_cosine) - p) * scale,
          (y_origin + y_ray * ((plane - Dot(n, y_origin)) / y_cosine) - p) * scale};
}

KindList CameraKinds() {
  return kCameraTable.List();
}

}  // namespace tessera
