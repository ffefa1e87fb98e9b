// A LightSource that moves: sampled where it is at the first key of its transform, its base, after the point
// that it lights was moved there.
#pragma once

#include "renderer/light/light_kind.h"
#include "renderer/math/moving_transform.h"

namespace tessera {

class LightMotion {
 public:
  // `is_infinite`: the light has no place, only directions.
  LightMotion(const Transform& render_from_world, const AnimatedTransform& world_from_light,
              bool is_infinite);

  bool is_infinite() const { return is_infinite_; }
  // Flat if the light has no volume at that time.
  Transform RenderFromBase(float time_s) const { return render_from_base_.At(time_s); }

  // The profile of the light at all times, from that at its base.
  LightProfile AtAllTimes(LightProfile at_base, TimeRange times) const;

 private:
  MovingTransform render_from_base_;
  bool is_infinite_;
};

// From a sample that was taken at the base, from `there`, to one at `reference`.
LightSample MoveSample(const Transform& render_from_base, const LightSample& at_base, bool is_infinite,
                       const ReferencePoint& there, const ReferencePoint& reference, float scene_radius);

}  // namespace tessera
