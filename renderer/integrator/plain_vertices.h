// Vertices of several paths on plain surfaces, computed together: what PathTracer computes for each, to the
// last bit, in a fraction of the time.
#pragma once

#include "renderer/integrator/path_tracer.h"
#include "renderer/integrator/plain_surfaces.h"
#include "renderer/math/ray_lanes.h"
#include "renderer/shape/hit_lanes.h"
#include "renderer/shape/triangle_lanes.h"

namespace tessera {

// The kind of path that PlainVertices follows.
using SurfacePath = PathTracer<VacuumTransport, RadianceSink>;

struct SurfacePaths {
  HitLanes hits;  // not refined (LaneSearch::Find)
  SurfacePath* paths[kLanes];
};

// Follows paths that meet plain surfaces. Used by one thread at a time.
class PlainVertices {
 public:
  // What became of the paths.
  struct Outcome {
    LaneSet refused = 0;  // not followed: they are as before
    LaneSet ended = 0;
  };

  // Both must outlive it.
  PlainVertices(const World& world, const PlainSurfaces& surfaces)
      : world_(world), surfaces_(surfaces), only_light_(world.lights.OnlyLight()) {}

  // Follows the paths of `lanes`, whose hits are on plain surfaces, from there to where their next rays
  // start.
  Outcome Scatter(LaneSet lanes, const SurfacePaths& paths);

 private:
  // Numbers of each lane, one by one.
  struct LaneFloats {
    alignas(32) float at[kLanes] = {};

    Float8 Load() const { return Float8::Load(at); }
  };
  struct LaneVectors {
    LaneFloats x, y, z;

    void Set(int lane, Vec3 v) {
      x.at[lane] = v.x;
      y.at[lane] = v.y;
      z.at[lane] = v.z;
    }
    Vec3x8 Load() const { return {x.Load(), y.Load(), z.Load()}; }
  };
  // Lights that were sampled, in the lanes of lit_.
  struct SampledLights {
    Vec3x8 p, p_error, n, wi;
    Float8 pdf;
  };

  // The steps of Scatter, in this order.
  void Place(const Rays8& rays);
  void BeginEvents();
  void ChooseLights();
  void SampleRectangles();
  void SampleDirections();
  void AddLights(const Rays8& rays);
  void Leave(const Rays8& rays);

  const std::optional<RectangleLight>& RectangleOf(int light) {
    if (light != last_light_) {
      last_light_ = light;
      last_rectangle_ = world_.lights.RectangleOf(light);
    }
    return last_rectangle_;
  }
  void SampleAlone(int lane);
  void SampleRectangle(LaneSet lanes, int light);
  SampledLights SampledAlone() const;
  // Sets lights_ in some lanes.
  void SetLights(LaneSet lanes, const SampledLights& lights);

  SurfacePath& path(int lane) const { return *paths_->paths[lane]; }
  void End(int lane) { lanes_ &= ~(LaneSet{1} << lane); }

  const World& world_;
  const PlainSurfaces& surfaces_;
  const std::optional<ChosenLight> only_light_;  // what LightTable::Choose always returns, if that is known
  const SurfacePaths* paths_ = nullptr;
  LaneSet lanes_ = 0;  // whose paths go on
  SurfacePoints8 points_;
  Float8 wo_z_;  // cosines of the directions against the rays
  SampledSpectrum f_[kLanes];

  // The light that was chosen last.
  int last_light_ = -1;
  std::optional<RectangleLight> last_rectangle_;
  // Lights that were chosen, with the probability of the choice and that of sampling any light.
  ChosenLight chosen_[kLanes];
  LaneFloats pmf_, share_;
  LaneFloats u_light_x_, u_light_y_;
  LaneSet in_rectangles_ = 0;  // lanes that are to sample a rectangle
  LaneSet lit_ = 0;            // lanes that have sampled a light
  LaneSet delta_ = 0;          // those whose light is LightSample::is_delta
  SampledLights lights_;
  LightSample samples_[kLanes];                             // of the radiance; the rest is in lights_
  LaneVectors alone_p_, alone_error_, alone_n_, alone_wi_;  // sampled one by one
  LaneFloats alone_pdf_;

  Ray shadow_rays_[kLanes];

  LaneFloats u_direction_x_, u_direction_y_;
  LaneSet directed_ = 0;  // lanes that have a direction
  Vec3x8 wi_;
  Float8 wi_pdf_;
};

}  // namespace tessera
