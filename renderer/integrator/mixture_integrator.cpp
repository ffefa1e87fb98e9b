#include "renderer/integrator/mixture_integrator.h"

#include <algorithm>

#include "renderer/integrator/light_walk.h"
#include "renderer/integrator/path_vertex.h"

namespace tessera {
namespace {

constexpr float kLightShare = 0.5f;  // of the directions that are drawn towards lights

// How often the lights are asked where a surface scatters; all else leaves it to the BSDF.
float LightShare(const LightDirections& lights, const Bsdf& bsdf) {
  return lights.empty() || !bsdf.HasNonSpecular() ? 0 : kLightShare;
}
float LightShare(const LightDirections& lights) {
  return lights.empty() ? 0 : kLightShare;
}

// One vertex on its way to a sample.
struct MixtureVertex {
  const LightDirections& lights;
  const SampledWavelengths& wavelengths;
  ReferencePoint reference;
  float light_share;

  std::optional<LightDirections::Drawn> DrawLight(float u_choice, Point2 u) const {
    return lights.Sample(reference, u_choice / light_share, u, wavelengths);
  }
  float Density(const Ray& ray, float own_pdf, float light_pdf_min) const {
    float density = (1 - light_share) * own_pdf;
    // The point that was drawn may be missed by rounding, on an edge.
    if (light_share > 0)
      density += light_share * std::max(lights.Pdf(reference, ray, wavelengths), light_pdf_min);
    return density;
  }
  // `f_cosine`: what scatters along `ray`, with its cosine; `own_pdf`: the density of the BSDF or the phase
  // function; `light_pdf_min`: what the density of light sampling is known to be at least.
  std::optional<MixtureSample> Weigh(const Ray& ray, SampledSpectrum f_cosine, float own_pdf,
                                     float light_pdf_min) const {
    if (!AnyNonZero(f_cosine)) return std::nullopt;
    const float density = Density(ray, own_pdf, light_pdf_min);
    if (!(density > 0)) return std::nullopt;
    return MixtureSample{f_cosine * (1 / density), ray, density, false};
  }
};

float Remaining(float u_choice, float light_share) {
  return (u_choice - light_share) / (1 - light_share);
}

Ray RayFrom(const Ray& ray, Vec3 wi) {
  return {ray.o, wi, std::numeric_limits<float>::infinity(), ray.time};
}

}  // namespace

std::optional<MixtureSample> SampleMixture(const LightDirections& lights,
                                           const SurfaceInteraction& interaction, const Bsdf& bsdf,
                                           float u_choice, Point2 u, const SampledWavelengths& wavelengths) {
  const MixtureVertex vertex{lights, wavelengths, ReferenceAt(interaction), LightShare(lights, bsdf)};
  if (u_choice < vertex.light_share) {
    const auto drawn = vertex.DrawLight(u_choice, u);
    if (!drawn) return std::nullopt;
    const BsdfEvaluation evaluation = bsdf.Evaluate(interaction.wo, drawn->wi);
    const SampledSpectrum f_cosine = evaluation.f * AbsDot(drawn->wi, interaction.shading.n);
    return vertex.Weigh(interaction.SpawnRay(drawn->wi), f_cosine, evaluation.pdf, drawn->chosen_pdf);
  }
  const auto drawn = bsdf.Sample(interaction.wo, Remaining(u_choice, vertex.light_share), u);
  if (!drawn) return std::nullopt;
  const Ray ray = interaction.SpawnRay(drawn->wi);
  const SampledSpectrum f_cosine = drawn->f * AbsDot(drawn->wi, interaction.shading.n);
  if (!drawn->IsSpecular()) return vertex.Weigh(ray, f_cosine, drawn->pdf, 0);
  const float probability = (1 - vertex.light_share) * drawn->pdf;
  return MixtureSample{f_cosine * (1 / probability), ray, probability, true};
}

float MixturePdf(const LightDirections& lights, const SurfaceInteraction& interaction, const Bsdf& bsdf,
                 Vec3 wi, const SampledWavelengths& wavelengths) {
  const MixtureVertex vertex{lights, wavelengths, ReferenceAt(interaction), LightShare(lights, bsdf)};
  return vertex.Density(interaction.SpawnRay(wi), bsdf.Evaluate(interaction.wo, wi).pdf, 0);
}

std::optional<MixtureSample> SampleMixture(const LightDirections& lights, const Ray& ray,
                                           const PhaseFunction& phase, float u_choice, Point2 u,
                                           const SampledWavelengths& wavelengths) {
  const MixtureVertex vertex{lights, wavelengths, {ray.o, {}, {}, {}}, LightShare(lights)};
  if (u_choice < vertex.light_share) {
    const auto drawn = vertex.DrawLight(u_choice, u);
    if (!drawn) return std::nullopt;
    const float value = phase.Evaluate(-ray.d, drawn->wi);
    return vertex.Weigh(RayFrom(ray, drawn->wi), SampledSpectrum(value), value, drawn->chosen_pdf);
  }
  const PhaseSample drawn = phase.Sample(-ray.d, u);
  return vertex.Weigh(RayFrom(ray, drawn.wi), SampledSpectrum(drawn.pdf), drawn.pdf, 0);
}

float MixturePdf(const LightDirections& lights, const Ray& ray, const PhaseFunction& phase, Vec3 wi,
                 const SampledWavelengths& wavelengths) {
  const MixtureVertex vertex{lights, wavelengths, {ray.o, {}, {}, {}}, LightShare(lights)};
  return vertex.Density(RayFrom(ray, wi), phase.Pdf(-ray.d, wi), 0);
}

SampledSpectrum MixtureRadiance(const World& world, const LightDirections& lights,
                                const PathSettings& settings, const Ray& camera_ray,
                                SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  LightWalk walk(world, camera_ray, wavelengths, counts);
  for (int depth = 0;; ++depth) {
    const LightWalk::Event event = walk.Advance(sampler);
    if (event == LightWalk::Event::kEscaped) walk.AddInfiniteEmission();
    if (event == LightWalk::Event::kOnSurface) walk.AddSurfaceEmission();
    if (event == LightWalk::Event::kEscaped || depth == settings.max_depth) return walk.radiance;
    const float u_choice = sampler.Get1D();
    const Point2 u_direction = sampler.Get2D();
    std::optional<MixtureSample> sample;
    if (event == LightWalk::Event::kInMedium) {
      sample = SampleMixture(lights, walk.ray, walk.phase(), u_choice, u_direction, wavelengths);
    } else {
      const Bsdf bsdf = walk.Scatterer(settings);
      sample = SampleMixture(lights, walk.interaction, bsdf, u_choice, u_direction, wavelengths);
    }
    if (!sample) return walk.radiance;
    walk.Leave(sample->ray, sample->weight);
  }
}

}  // namespace tessera
