#include "renderer/integrator/mixture_integrator.h"

#include <algorithm>

#include "renderer/integrator/light_walk.h"
#include "renderer/integrator/path_vertex.h"

namespace tessera {
namespace {

constexpr float kLightShare = 0.5f;  // of the directions that are drawn towards lights

// The probability of drawing a direction towards the lights where a surface scatters; the rest is the BSDF's.
float LightShare(const LightDirections& lights, const Bsdf& bsdf) {
  return lights.empty() || !bsdf.HasNonSpecular() ? 0 : kLightShare;
}
float LightShare(const LightDirections& lights) {
  return lights.empty() ? 0 : kLightShare;
}

// What a vertex needs to draw and weight a direction.
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
    // On an edge, rounding may make Pdf miss the point that was drawn.
    if (light_share > 0)
      density += light_share * std::max(lights.Pdf(reference, ray, wavelengths), light_pdf_min);
    return density;
  }
  // `f_cosine`: the value of the BSDF or the phase function along `ray`, with its cosine; `own_pdf`: its
  // density; `light_pdf_min`: a lower bound of the density of light sampling.
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
  const MixtureVertex vertex{lights, wavelengths, ReferenceAt(interaction, bsdf), LightShare(lights, bsdf)};
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
  const MixtureVertex vertex{lights, wavelengths, ReferenceAt(interaction, bsdf), LightShare(lights, bsdf)};
  return vertex.Density(interaction.SpawnRay(wi), bsdf.Evaluate(interaction.wo, wi).pdf, 0);
}

std::optional<MixtureSample> SampleMixture(const LightDirections& lights, const Ray& ray,
                                           const PhaseFunction& phase, float u_choice, Point2 u,
                                           const SampledWavelengths& wavelengths) {
  const MixtureVertex vertex{lights, wavelengths, {ray.o, {}, {}, {}, ray.time}, LightShare(lights)};
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
  const MixtureVertex vertex{lights, wavelengths, {ray.o, {}, {}, {}, ray.time}, LightShare(lights)};
  return vertex.Density(RayFrom(ray, wi), phase.Pdf(-ray.d, wi), 0);
}

template <typename Sink>
void TraceMixture(const PathContext& context, const LightDirections& lights, const Ray& camera_ray,
                  Sink& sink) {
  using Event = typename LightWalk<Sink>::Event;
  LightWalk<Sink> walk(context, camera_ray, sink);
  for (;;) {
    const Event event = walk.Advance();
    if (event == Event::kEscaped) walk.AddInfiniteEmission();
    if (event == Event::kOnSurface) walk.AddSurfaceEmission();
    if (walk.EndsAt(event)) return;
    const float u_choice = context.sampler.Get1D();
    const Point2 u_direction = context.sampler.Get2D();
    std::optional<MixtureSample> sample;
    FirstVertex vertex{FirstScatter::kMedium};
    if (event == Event::kInMedium) {
      sample = SampleMixture(lights, walk.ray, walk.phase(), u_choice, u_direction, context.wavelengths);
    } else {
      const Bsdf bsdf = walk.Scatterer();
      sample = SampleMixture(lights, walk.interaction, bsdf, u_choice, u_direction, context.wavelengths);
      if (sample) vertex = walk.VertexOf(bsdf, sample->ray.d, sample->is_specular);
    }
    if (!sample) return;
    walk.Leave(sample->ray, sample->weight, vertex, sample->is_specular);
  }
}

template void TraceMixture(const PathContext&, const LightDirections&, const Ray&, RadianceSink&);
template void TraceMixture(const PathContext&, const LightDirections&, const Ray&, RecordingSink&);

}  // namespace tessera
