// A ray on its way from one place where light scatters to the next, for estimators that find light where rays
// hit it: through `interface` surfaces and media, collecting what media emit.
#pragma once

#include "renderer/integrator/medium_tracker.h"
#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/world.h"
#include "renderer/sampler/sampler.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The state of one path. Distances to collisions in media are drawn for one of the four wavelengths, chosen
// anew for each flight, and weighted by the mean of their densities (the one-sample model of multiple
// importance sampling, Veach and Guibas 1995): not the way of `volpath`, which it can so check.
class LightWalk {
 public:
  enum class Event {
    kEscaped,    // the ray left the scene
    kOnSurface,  // at `interaction`, which is no interface
    kInMedium,   // at ray.o, which is moved there; interaction is that of an earlier surface
  };

  LightWalk(const World& world, const Ray& camera_ray, SampledWavelengths& wavelengths, RayCounts& counts);

  // To the next event. Draws random numbers only inside media.
  Event Advance(Sampler& sampler);
  // Leaves the surface or the point in a medium where the last event was, along ray.d; `weight` is that of
  // the radiance that will arrive.
  void Leave(const Ray& next, SampledSpectrum weight);
  // Adds what the surface of the last event emits, or the lights at infinity if the ray escaped.
  void AddSurfaceEmission();
  void AddInfiniteEmission();

  // What scatters at the surface of the last event; may change its shading normal and drop wavelengths.
  Bsdf Scatterer(const PathSettings& settings);
  // What scatters in the medium of the last event.
  const PhaseFunction& phase() const { return world_.media[medium_].phase(); }

  SampledSpectrum radiance{0.0f}, throughput{1.0f};
  Ray ray;
  SurfaceInteraction interaction;

 private:
  // Flies through the medium up to t_max; true if there was a collision before.
  bool Collides(float t_max, Sampler& sampler);

  const World& world_;
  SampledWavelengths& wavelengths_;
  RayCounts& counts_;
  MediumTracker tracker_;
  int medium_ = -1;
  bool in_medium_ = false;  // the last event
  bool left_camera_ = false;
};

}  // namespace tessera
