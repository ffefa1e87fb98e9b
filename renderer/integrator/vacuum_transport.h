// The way of a path and its weights where no ray is in a medium: one throughput for all techniques.
#pragma once

#include <optional>

#include "renderer/integrator/path_vertex.h"
#include "renderer/math/sampling.h"

namespace tessera {

// Where the flight of a ray ended.
enum class FlightEvent {
  kEscaped,    // outside the scene
  kOnSurface,  // at the hit
  kInMedium,   // at a collision that scatters
  kAbsorbed,
};

// A Transport of PathTracer (path_integrator.cpp). The state of one path.
class VacuumTransport {
 public:
  static constexpr bool kHasMedia = false;

  explicit VacuumTransport(const PathContext& context) : context_(context) {}

  // Flies along `ray` to the next event. Updates the weights; may shorten the ray; sets *hit if it ends on a
  // surface, *t_event if it ends in a medium; adds to *emitted what media on the way contribute.
  FlightEvent Fly(Ray& ray, Hit* hit, float* /*t_event*/, SampledSpectrum* /*emitted*/) {
    return context_.world.accelerator->Intersect(ray, hit) ? FlightEvent::kOnSurface : FlightEvent::kEscaped;
  }
  // The contribution of radiance `emitted` that the ray hit. light_pdf: the density with which light sampling
  // finds it from where the ray started; nullopt if it could not be used there.
  SampledSpectrum HitContribution(SampledSpectrum emitted, std::optional<float> light_pdf) const {
    const float weight = light_pdf ? PowerHeuristic(pdf_, *light_pdf) : 1;
    return throughput_ * emitted * weight;
  }
  // The contribution of a sampled light, or nullopt if something is in the way. `shadow` leads there; the
  // vertex scatters f times the cosine, and samples that direction with density pdf.
  std::optional<SampledSpectrum> LightContribution(const SampledLight& sampled, const Ray& shadow,
                                                   const SurfaceInteraction&, SampledSpectrum f, float cosine,
                                                   float pdf) {
    ++context_.counts.shadow;
    if (sampled.casts_shadows && context_.world.accelerator->Occluded(shadow)) return std::nullopt;
    const float weight = sampled.light.is_delta ? 1 : PowerHeuristic(sampled.pdf, pdf);
    return throughput_ * (f * sampled.light.Radiance(context_.wavelengths) * (cosine * weight / sampled.pdf));
  }

  // What the light would contribute if nothing were in the way and light sampling were the only technique.
  SampledSpectrum LightUnlessBlocked(const SampledLight& sampled, SampledSpectrum f_cosine) const {
    return throughput_ * f_cosine * sampled.light.Radiance(context_.wavelengths) / sampled.pdf;
  }

  // The path goes on through an `interface` surface.
  void PassInterface(const SurfaceInteraction&, Vec3) {}
  // The path leaves a surface along wi, which was sampled with density pdf. `weight`: f times the cosine over
  // the density.
  void Scatter(const SurfaceInteraction&, Vec3, SampledSpectrum weight, float pdf) { Scatter(weight, pdf); }
  void Scatter(SampledSpectrum weight, float pdf) {
    throughput_ *= weight;
    pdf_ = pdf;
  }
  // A material has dropped all wavelengths but the first.
  void FollowFirstWavelength() {}
  // What the path brings of the radiance that it will find.
  SampledSpectrum Throughput() const { return throughput_; }
  // The path has survived Russian roulette.
  void Survive(float probability) { throughput_ /= probability; }
  // The path has ended.
  void Finish() {}

 private:
  const PathContext& context_;
  SampledSpectrum throughput_{1.0f};
  float pdf_ = 0;  // with which the current ray was sampled, per solid angle
};

}  // namespace tessera
