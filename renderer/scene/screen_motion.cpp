#include "renderer/scene/screen_motion.h"

#include <cmath>
#include <optional>

namespace tessera {
namespace {

constexpr int kStepsMax = 12;           // Newton's method: 3 to 5 are taken
constexpr float kStepEnd_px = 1e-3f;    // below which the place is found
constexpr float kErrorMax_px = 0.05f;   // of a place that counts as found
constexpr float kDifference_px = 0.5f;  // of the derivative

// What a ray is to lead to.
struct Aim {
  Point3 p;
  std::optional<Vec3> sky;  // a direction instead of the point

  Vec3 From(Point3 origin) const { return sky ? *sky : p - origin; }
};

// By how much the ray through a place of the film misses an aim: seen from the ray's origin, in units of the
// distance, along two axes across a fixed direction. Returns nullopt if no ray leaves there or the aim is not
// in front of it.
class Miss {
 public:
  Miss(const Camera& camera, const Aim& aim, float time_s, Point2 film)
      : camera_(camera), aim_(aim), time_s_(time_s) {
    frame_ = Frame::FromZ(RayAt(film).ray.d);
  }

  std::optional<Vec2> At(Point2 film) const {
    const CameraSample seen = RayAt(film);
    if (!(seen.weight > 0)) return std::nullopt;
    const Vec3 wanted = frame_.ToLocal(aim_.From(seen.ray.o)), found = frame_.ToLocal(seen.ray.d);
    if (!(wanted.z > 0) || !(found.z > 0)) return std::nullopt;
    return Vec2{wanted.x / wanted.z - found.x / found.z, wanted.y / wanted.z - found.y / found.z};
  }

 private:
  CameraSample RayAt(Point2 film) const { return camera_.GenerateRayAt(film, {0.5f, 0.5f}, time_s_); }

  const Camera& camera_;
  const Aim& aim_;
  float time_s_;
  Frame frame_;
};

// The place of the film whose ray through the centre of the lens leads to the aim, by Newton's method from
// `film`: it asks nothing of a camera but its rays. Returns nullopt if none is found.
std::optional<Point2> FindOnFilm(const Camera& camera, const Aim& aim, float time_s, Point2 film) {
  for (int step = 0; step < kStepsMax; ++step) {
    const Miss miss(camera, aim, time_s, film);
    const std::optional<Vec2> here = miss.At(film);
    const std::optional<Vec2> right = miss.At({film.x + kDifference_px, film.y});
    const std::optional<Vec2> below = miss.At({film.x, film.y + kDifference_px});
    if (!here || !right || !below) return std::nullopt;
    const Vec2 dx{(right->x - here->x) / kDifference_px, (right->y - here->y) / kDifference_px};
    const Vec2 dy{(below->x - here->x) / kDifference_px, (below->y - here->y) / kDifference_px};
    const float determinant = dx.x * dy.y - dx.y * dy.x;
    if (!(std::abs(determinant) > 0)) return std::nullopt;
    const Vec2 move{(here->y * dy.x - here->x * dy.y) / determinant,
                    (here->x * dx.y - here->y * dx.x) / determinant};
    film = {film.x + move.x, film.y + move.y};
    const float length = std::hypot(move.x, move.y);
    if (!std::isfinite(length)) return std::nullopt;
    if (length < kStepEnd_px || (step == kStepsMax - 1 && length < kErrorMax_px)) return film;
  }
  return std::nullopt;
}

// Where the point of the hit is at another time.
Point3 PointAt(const World& world, const Hit& hit, const SurfaceInteraction& interaction, float time_s) {
  if (hit.instance == Hit::kNoInstance) return interaction.p;
  const Instance& instance = world.geometry.instances[hit.instance];
  if (instance.motion < 0) return interaction.p;
  const MovingTransform& motion = world.geometry.motions[static_cast<size_t>(instance.motion)];
  const Transform now = motion.At(interaction.time);
  if (IsFlat(now)) return interaction.p;
  return motion.At(time_s).ToPoint(now.Inverse().ToPoint(interaction.p));
}

}  // namespace

Vec2 ScreenMotion(const World& world, const Hit& hit, const SurfaceInteraction& interaction, Point2 film,
                  const TimeRange& times) {
  const Camera& camera = world.camera;
  const bool rests = hit.instance == Hit::kNoInstance || world.geometry.instances[hit.instance].motion < 0;
  if (rests && !camera.moves()) return {0, 0};
  const auto place_at = [&](float time_s) {
    const Aim aim{PointAt(world, hit, interaction, time_s), std::nullopt};
    return FindOnFilm(camera, aim, time_s, film).value_or(film);
  };
  const Point2 from = place_at(times.start), to = place_at(times.end);
  return {to.x - from.x, to.y - from.y};
}

Vec2 ScreenMotionOfSky(const Camera& camera, Point2 film, float time_s, const TimeRange& times) {
  if (!camera.moves()) return {0, 0};
  const Aim aim{{}, camera.GenerateRayAt(film, {0.5f, 0.5f}, time_s).ray.d};
  const Point2 from = FindOnFilm(camera, aim, times.start, film).value_or(film);
  const Point2 to = FindOnFilm(camera, aim, times.end, film).value_or(film);
  return {to.x - from.x, to.y - from.y};
}

}  // namespace tessera
