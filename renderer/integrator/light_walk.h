// A ray on its way from one place where light scatters to the next, for integrators that find light where
// rays hit it: through `interface` surfaces and media, collecting what media emit.
#pragma once

#include "renderer/integrator/medium_tracker.h"
#include "renderer/integrator/sample_record.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The state of one path. Distances to collisions in media are drawn for one of the four wavelengths, chosen
// anew for each flight, and weighted by the mean of their densities (the one-sample model of multiple
// importance sampling, Veach and Guibas 1995). `volpath` does it in another way, so the two check each other.
template <typename Sink>
class LightWalk {
 public:
  enum class Event {
    kEscaped,    // the ray left the scene
    kOnSurface,  // at `interaction`, which is not an interface
    kInMedium,   // at ray.o, which is moved there; interaction is that of an earlier surface
  };

  // `context` must outlive this.
  LightWalk(const PathContext& context, const Ray& camera_ray, Sink& sink);

  // Moves to the next event. Draws random numbers only inside media.
  Event Advance();
  // Whether the path ends at the event: outside the scene or at the depth limit.
  bool EndsAt(Event event) const { return event == Event::kEscaped || depth_ == context_.settings.max_depth; }
  // Leaves the surface or the point in a medium where the last event was, along next.d; `weight` is that of
  // the radiance that will arrive.
  void Leave(const Ray& next, SampledSpectrum weight, const FirstVertex& vertex, bool is_specular);

  // Adds what the surface of the last event emits.
  void AddSurfaceEmission();
  // Adds the lights at infinity. The ray has escaped.
  void AddInfiniteEmission();
  void AddInfiniteEmission(int light);
  // Adds light that a shadow ray found from the last event. `radiance` is what the event scatters of it.
  void AddLight(SampledSpectrum radiance, int light, const FirstVertex& vertex) {
    sink_.Add(throughput_ * radiance, {light, depth_ + 1, depth_ == 0 ? vertex : first_});
  }
  // Light that something keeps from the last event, which would scatter `radiance` of it.
  void AddShadow(SampledSpectrum radiance) {
    if constexpr (Sink::kRecords) {
      if (depth_ == 0 && sink_.needs().shadow) sink_.AddShadow(throughput_ * radiance);
    }
  }
  // What Leave and AddLight take of a surface that scatters light from wi.
  FirstVertex VertexOf(const Bsdf& bsdf, Vec3 wi, bool is_specular) const {
    if constexpr (Sink::kRecords) {
      if (depth_ == 0 && sink_.needs().lobes) return FirstVertexAt(bsdf, interaction.wo, wi, is_specular);
    }
    return {};
  }

  // What scatters at the surface of the last event; may change its shading normal and drop wavelengths.
  Bsdf Scatterer();
  // What scatters in the medium of the last event.
  const PhaseFunction& phase() const { return context_.world.media[medium_].phase(); }

  Ray ray;
  SurfaceInteraction interaction;

 private:
  // Flies through the current medium up to t_max. Returns true if there was a collision before.
  bool Collides(const HomogeneousCoefficients& medium, float t_max);
  // Of media that vary, by spectral tracking (P. Kutz, R. Habel, Y. K. Li, J. Novak, "Spectral and
  // Decomposition Tracking for Rendering Heterogeneous Volumes", 2017): no wavelength decides alone.
  template <typename Coefficients>
  bool Collides(const Coefficients& medium, float t_max);
  void Add(SampledSpectrum radiance, int light) {
    sink_.Add(throughput_ * radiance, {light, depth_, first_});
  }
  bool CountsHit(int light) const;

  const PathContext& context_;
  Sink& sink_;
  MediumTracker tracker_;
  SampledSpectrum throughput_{1.0f};
  Point3 origin_;  // where the path last scattered
  int medium_ = -1;
  int depth_ = 0;  // scattering events left behind
  FirstVertex first_;
  bool in_medium_ = false;     // the last event
  bool was_specular_ = false;  // the last scattering event
  bool was_spread_ = false;    // whether any was not specular
  // Whether the ray has passed hidden surfaces that cast shadows since then.
  bool is_shadowed_ = false;
  uint64_t light_links_ = kAllLightLinks;  // of where it was
};

}  // namespace tessera
