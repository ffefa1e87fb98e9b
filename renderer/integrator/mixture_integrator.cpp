#include "integrator/mixture_integrator.h"

#include <algorithm>

#include "integrator/emission_on_hit.h"
#include "integrator/texture_context.h"

namespace tessera {
namespace {

constexpr float kLightShare = 0.5f;  // of the directions that are drawn towards lights

// At a surface that scatters: how often the lights are asked.
float LightShare(const LightDirections& lights, const Bsdf& bsdf) {
  return lights.empty() || !bsdf.HasNonSpecular() ? 0 : kLightShare;
}

ReferencePoint ReferenceAt(const SurfaceInteraction& interaction) {
  return {interaction.p, interaction.p_error, interaction.n, interaction.shading.n};
}

// A sample along wi, of which light sampling knows that its own density is at least `light_pdf_min`.
std::optional<MixtureSample> Weighted(const LightDirections& lights, const SurfaceInteraction& interaction,
                                      float light_share, Vec3 wi, const BsdfEvaluation& evaluation,
                                      float light_pdf_min, const SampledWavelengths& wavelengths) {
  if (!AnyNonZero(evaluation.f)) return std::nullopt;
  MixtureSample sample;
  sample.ray = interaction.SpawnRay(wi);
  sample.density = (1 - light_share) * evaluation.pdf;
  if (light_share > 0) {
    // The point that was drawn may be missed by rounding, on an edge.
    const float light_pdf = lights.Pdf(ReferenceAt(interaction), sample.ray, wavelengths);
    sample.density += light_share * std::max(light_pdf, light_pdf_min);
  }
  if (!(sample.density > 0)) return std::nullopt;
  sample.weight = evaluation.f * (AbsDot(wi, interaction.shading.n) / sample.density);
  return sample;
}

}  // namespace

std::optional<MixtureSample> SampleMixture(const LightDirections& lights,
                                           const SurfaceInteraction& interaction, const Bsdf& bsdf,
                                           float u_choice, Point2 u, const SampledWavelengths& wavelengths) {
  const float light_share = LightShare(lights, bsdf);
  if (u_choice < light_share) {
    const auto drawn = lights.Sample(ReferenceAt(interaction), u_choice / light_share, u, wavelengths);
    if (!drawn) return std::nullopt;
    return Weighted(lights, interaction, light_share, drawn->wi, bsdf.Evaluate(interaction.wo, drawn->wi),
                    drawn->chosen_pdf, wavelengths);
  }
  u_choice = (u_choice - light_share) / (1 - light_share);
  const std::optional<BsdfSample> drawn = bsdf.Sample(interaction.wo, u_choice, u);
  if (!drawn) return std::nullopt;
  if (!drawn->IsSpecular()) {
    return Weighted(lights, interaction, light_share, drawn->wi, {drawn->f, drawn->pdf}, 0, wavelengths);
  }
  MixtureSample sample;
  sample.is_specular = true;
  sample.ray = interaction.SpawnRay(drawn->wi);
  sample.density = (1 - light_share) * drawn->pdf;
  sample.weight = drawn->f * (AbsDot(drawn->wi, interaction.shading.n) / sample.density);
  return sample;
}

float MixturePdf(const LightDirections& lights, const SurfaceInteraction& interaction, const Bsdf& bsdf,
                 Vec3 wi, const SampledWavelengths& wavelengths) {
  const float light_share = LightShare(lights, bsdf);
  const float light_pdf =
      light_share > 0 ? lights.Pdf(ReferenceAt(interaction), interaction.SpawnRay(wi), wavelengths) : 0;
  return (1 - light_share) * bsdf.Evaluate(interaction.wo, wi).pdf + light_share * light_pdf;
}

SampledSpectrum MixtureRadiance(const World& world, const LightDirections& lights,
                                const PathSettings& settings, const Ray& camera_ray,
                                SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  SampledSpectrum radiance(0.0f), throughput(1.0f);
  Ray ray = camera_ray;
  for (int depth = 0;; ++depth) {
    auto interaction = FollowRay(world, ray, depth == 0 ? counts.camera : counts.bounce);
    if (!interaction) return radiance + throughput * EmissionBeyond(world, ray.d, wavelengths);
    radiance += throughput * EmissionAt(world, *interaction, wavelengths);
    if (depth == settings.max_depth) return radiance;
    const TextureContext context = MakeTextureContext(*interaction, world.camera, settings.footprint_scale);
    const Bsdf bsdf =
        world.materials.Evaluate(interaction->material, world.textures, context, *interaction, wavelengths);
    const float u_choice = sampler.Get1D();
    const Point2 u_direction = sampler.Get2D();
    const auto sample = SampleMixture(lights, *interaction, bsdf, u_choice, u_direction, wavelengths);
    if (!sample) return radiance;
    throughput *= sample->weight;
    ray = sample->ray;
  }
}

}  // namespace tessera
