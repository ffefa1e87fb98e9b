#include "renderer/light/light_motion.h"

#include "renderer/shape/moved_sampling.h"

namespace tessera {
namespace {

MovingTransform FromBase(const Transform& render_from_world, const AnimatedTransform& world_from_light) {
  const Transform base = render_from_world * world_from_light.First();
  const AnimatedTransform factors[] = {AnimatedTransform(render_from_world), world_from_light,
                                       AnimatedTransform(base.Inverse())};
  return MovingTransform(factors);
}

}  // namespace

LightMotion::LightMotion(const Transform& render_from_world, const AnimatedTransform& world_from_light,
                         bool is_infinite)
    : render_from_base_(FromBase(render_from_world, world_from_light)), is_infinite_(is_infinite) {}

LightProfile LightMotion::AtAllTimes(LightProfile at_base, TimeRange times) const {
  if (!at_base.bounds) return at_base;
  LightBounds& bounds = *at_base.bounds;
  bounds.box = render_from_base_.BoundsOf(bounds.box, times.start, times.end);
  bounds.AddAllDirections();  // it may turn
  return at_base;
}

LightSample MoveSample(const Transform& render_from_base, const LightSample& at_base, bool is_infinite,
                       const ReferencePoint& there, const ReferencePoint& reference, float scene_radius) {
  LightSample sample = at_base;
  if (is_infinite) {
    sample.wi = Normalize(render_from_base.ToVector(at_base.wi));
    sample.p = reference.p + sample.wi * (2 * scene_radius);
    if (!sample.is_delta) sample.pdf *= SolidAngleRatio(render_from_base, sample.wi);
    return sample;
  }
  // Of a point: its intensity stays, its distance is the true one.
  sample.p = render_from_base.ToPoint(at_base.p);
  const Vec3 to_light = sample.p - reference.p;
  sample.wi = Normalize(to_light);
  sample.L *= LengthSquared(at_base.p - there.p) / LengthSquared(to_light);
  return sample;
}

}  // namespace tessera
