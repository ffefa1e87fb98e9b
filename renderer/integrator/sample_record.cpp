#include "renderer/integrator/sample_record.h"

#include "renderer/integrator/path_vertex.h"

namespace tessera {
namespace {

// By Monte Carlo integration with fixed points (Hammersley 1960), so that it varies smoothly over a surface
// and draws nothing from the sampler.
SampledSpectrum AlbedoOf(const Bsdf& bsdf, const SurfaceInteraction& interaction) {
  constexpr uint32_t kBits = 4, kPoints = 1 << kBits;
  SampledSpectrum sum(0.0f);
  for (uint32_t i = 0; i < kPoints; ++i) {
    uint32_t reversed = 0;
    for (uint32_t bit = 0; bit < kBits; ++bit) reversed |= (i >> bit & 1) << (kBits - 1 - bit);
    const float u_component = (static_cast<float>(i) + 0.5f) / kPoints;
    // The second coordinate must not follow the component, which i chooses in order.
    const Point2 u{(static_cast<float>(reversed) + 0.5f) / kPoints,
                   (static_cast<float>(i * 5 % kPoints) + 0.5f) / kPoints};
    const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u);
    if (!sample) continue;
    // Light that leaves a denser medium loses what entering it gains: without Sqr(eta), glass would not be
    // clear.
    const float spread = sample->IsTransmission() ? Sqr(sample->eta) : 1;
    sum += sample->f * (AbsDot(sample->wi, interaction.shading.n) * spread / sample->pdf);
  }
  return sum * (1.0f / kPoints);
}

}  // namespace

void RecordingSink::ReachFirstSurface(const PathContext& context, const Hit& hit,
                                      const SurfaceInteraction& interaction) {
  if (!needs().surface) return;
  SurfaceInteraction surface = interaction;
  SampledWavelengths wavelengths = context.wavelengths;
  Sampler sampler = context.sampler;
  const Bsdf bsdf = BsdfAt({context.world, context.settings, wavelengths, sampler, context.counts}, surface);
  const SampledSpectrum albedo = needs().albedo ? AlbedoOf(bsdf, surface) : SampledSpectrum(0.0f);
  recorder_.AddFirstHit({hit, surface, Length(surface.p - origin_), albedo});
  seeks_mirrored_ = needs().mirrored && !bsdf.HasNonSpecular();
}

void RecordingSink::SeekMirrored(const PathContext& context, const SurfaceInteraction& interaction,
                                 SampledSpectrum throughput) {
  SurfaceInteraction surface = interaction;
  SampledWavelengths wavelengths = context.wavelengths;
  Sampler sampler = context.sampler;
  const Bsdf bsdf = BsdfAt({context.world, context.settings, wavelengths, sampler, context.counts}, surface);
  if (!bsdf.HasNonSpecular()) return;
  seeks_mirrored_ = false;
  const SampledSpectrum albedo =
      needs().albedo ? AlbedoOf(bsdf, surface) * throughput : SampledSpectrum(0.0f);
  recorder_.AddMirrored({FaceForward(surface.shading.n, surface.wo), albedo});
}

}  // namespace tessera
