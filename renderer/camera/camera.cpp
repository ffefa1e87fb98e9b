#include "renderer/camera/camera.h"

#include <limits>

#include "renderer/description/parameter_reader.h"
#include "renderer/math/sampling.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kKinds[] = {"perspective"};
constexpr std::string_view kLaterKinds[] = {"orthographic", "realistic", "spherical"};
constexpr float kNearPlane = 0.01f, kFarPlane = 1000;  // of the projection alone: nothing is clipped

struct ScreenWindow {
  float x0, x1, y0, y1;
};

// The part of the image plane at distance 1 / tan(fov / 2) that the film covers.
ScreenWindow ReadScreenWindow(ParameterReader& reader, int width, int height) {
  const float aspect =
      reader.Float("frameaspectratio", static_cast<float>(width) / static_cast<float>(height));
  if (!(aspect > 0)) reader.FailAt("frameaspectratio", "frameaspectratio must be above 0");
  ScreenWindow window =
      aspect > 1 ? ScreenWindow{-aspect, aspect, -1, 1} : ScreenWindow{-1, 1, -1 / aspect, 1 / aspect};
  const std::vector<float> given = reader.Floats("screenwindow");
  if (given.size() == 4)
    window = {given[0], given[1], given[2], given[3]};
  else if (!given.empty())
    reader.FailAt("screenwindow", "screenwindow takes 4 numbers: x0 x1 y0 y1");
  if (!(window.x0 < window.x1 && window.y0 < window.y1)) {
    reader.FailAt("screenwindow", "screenwindow must have x0 < x1 and y0 < y1");
  }
  return window;
}

Result<void> CheckKind(const Entity& entity) {
  if (entity.kind == "perspective") return {};
  for (std::string_view later : kLaterKinds) {
    if (entity.kind == later)
      return ErrorAt(entity.location, "camera \"" + entity.kind + "\" is not supported yet");
  }
  return ErrorAt(entity.location, "unknown camera \"" + entity.kind + "\"" + DidYouMean(entity.kind, kKinds));
}

Transform CameraFromRaster(float fov, const ScreenWindow& window, int width, int height) {
  const Transform raster_from_ndc = Scale(static_cast<float>(width), static_cast<float>(-height), 1);
  const Transform ndc_from_screen = Scale(1 / (window.x1 - window.x0), 1 / (window.y1 - window.y0), 1) *
                                    Translate({-window.x0, -window.y1, 0});
  const Transform screen_from_camera = Perspective(fov, kNearPlane, kFarPlane);
  return (raster_from_ndc * ndc_from_screen * screen_from_camera).Inverse();
}

}  // namespace

Result<Camera> Camera::Read(const Entity& entity, const TransformPair& camera_from_world, int width,
                            int height) {
  if (Result<void> kind = CheckKind(entity); !kind) return kind.error();
  TESSERA_CHECK(!camera_from_world.IsAnimated());
  ParameterReader reader(entity);
  Camera camera;
  camera.shutter_open_ = reader.Float("shutteropen", 0);
  camera.shutter_close_ = reader.Float("shutterclose", 1);
  camera.lens_radius_ = reader.Float("lensradius", 0);
  camera.focal_distance_ = reader.Float("focaldistance", 1e6f);
  const float fov = reader.Float("fov", 90);
  const ScreenWindow window = ReadScreenWindow(reader, width, height);
  if (!(fov > 0 && fov < 180)) reader.FailAt("fov", "fov must lie between 0 and 180 degrees");
  if (camera.lens_radius_ < 0) reader.FailAt("lensradius", "lensradius must not be negative");
  if (!(camera.focal_distance_ > 0)) reader.FailAt("focaldistance", "focaldistance must be above 0");
  if (!(camera.shutter_close_ > camera.shutter_open_)) {
    reader.FailAt("shutterclose", "shutterclose must be later than shutteropen");
  }
  if (Result<void> done = reader.Finish(); !done) return done.error();

  const Transform world_from_camera = camera_from_world.start.Inverse();
  const Point3 eye = world_from_camera.ToPoint({0, 0, 0});
  camera.render_from_world_ = Translate(-eye);
  camera.render_from_camera_ = camera.render_from_world_ * world_from_camera;
  camera.camera_from_raster_ = CameraFromRaster(fov, window, width, height);

  constexpr int kPlaces = 64;  // along the diagonal of the film
  camera.spread_x_ = camera.spread_y_ = std::numeric_limits<float>::max();
  for (int i = 0; i < kPlaces; ++i) {
    const Point2 film{(i + 0.5f) / kPlaces * static_cast<float>(width),
                      (i + 0.5f) / kPlaces * static_cast<float>(height)};
    const Vec3 d = camera.GenerateRay(film, {0.5f, 0.5f}, 0).d;
    const Vec3 right = camera.GenerateRay({film.x + 1, film.y}, {0.5f, 0.5f}, 0).d;
    const Vec3 down = camera.GenerateRay({film.x, film.y + 1}, {0.5f, 0.5f}, 0).d;
    camera.spread_x_ = std::min(camera.spread_x_, Length(right - d));
    camera.spread_y_ = std::min(camera.spread_y_, Length(down - d));
  }
  return camera;
}

Ray Camera::GenerateRay(Point2 film, Point2 u_lens, float u_time) const {
  const Point3 on_film = camera_from_raster_.ToPoint({film.x, film.y, 0});
  Point3 o{0, 0, 0};
  Vec3 d = Normalize(on_film);
  if (lens_radius_ > 0) {
    const Point2 lens = SampleUniformDiskConcentric(u_lens) * lens_radius_;
    const Point3 focus = d * (focal_distance_ / d.z);
    o = {lens.x, lens.y, 0};
    d = Normalize(focus - o);
  }
  Ray ray;
  ray.o = render_from_camera_.ToPoint(o);
  ray.d = Normalize(render_from_camera_.ToVector(d));
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

}  // namespace tessera
