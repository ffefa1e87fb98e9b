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
    {"orthographic", Support::kSupported, Read<OrthographicCamera>},
    {"spherical", Support::kSupported, Read<SphericalCamera>},
    {"realistic", Support::kSupported, Read<RealisticCamera>},
};
constexpr KindTable<CameraReader> kCameraTable("camera", kCameras);

}  // namespace

Result<Camera> Camera::Read(const Entity& entity, const Transform& camera_from_world, const CameraFilm& film,
                            ImageCache& images, Diagnostics& diagnostics) {
  const Kind<CameraReader>* kind = kCameraTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kCameraTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  Camera camera;
  camera.shutter_open_ = reader.Float("shutteropen", 0);
  camera.shutter_close_ = reader.Float("shutterclose", 1);
  if (!(camera.shutter_close_ > camera.shutter_open_)) {
    reader.FailAt("shutterclose", "shutterclose must be later than shutteropen");
  }
  camera.kind_ = kind->reader({reader, film, images, diagnostics});
  if (Result<void> done = reader.Finish(); !done) return done.error();

  const Transform world_from_camera = camera_from_world.Inverse();
  const Point3 eye = world_from_camera.ToPoint({0, 0, 0});
  camera.render_from_world_ = Translate(-eye);
  camera.render_from_camera_ = camera.render_from_world_ * world_from_camera;
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
  const CameraRay in_camera_space =
      Dispatch(kind_, [=](const auto& kind) { return kind.GenerateRay(film, u_lens); });
  CameraSample sample;
  sample.ray.o = render_from_camera_.ToPoint(in_camera_space.o);
  sample.ray.d = Normalize(render_from_camera_.ToVector(in_camera_space.d));
  sample.ray.time = Lerp(u_time, shutter_open_, shutter_close_);
  sample.weight = in_camera_space.weight;
  return sample;
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
