#include "renderer/integrator/path_integrator.h"

#include "renderer/integrator/path_vertex.h"
#include "renderer/math/sampling.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {
namespace {

// One path from the camera, extended vertex by vertex.
class Path {
 public:
  Path(const World& world, const PathSettings& settings, const Ray& camera_ray,
       SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts)
      : world_(world),
        settings_(settings),
        ray_(camera_ray),
        wavelengths_(wavelengths),
        sampler_(sampler),
        counts_(counts) {}

  SampledSpectrum Trace();

 private:
  void AddInfiniteLights();
  void AddEmission(const SurfaceInteraction& interaction);
  SampledSpectrum DirectLight(const SurfaceInteraction& interaction, const Bsdf& bsdf);
  bool Scatter(const SurfaceInteraction& interaction, const Bsdf& bsdf);
  bool SurvivesRoulette();

  const World& world_;
  const PathSettings& settings_;
  Ray ray_;
  SampledWavelengths& wavelengths_;
  Sampler& sampler_;
  RayCounts& counts_;
  SampledSpectrum radiance_{0.0f}, throughput_{1.0f};
  int depth_ = 0;
  float bsdf_pdf_ = 0;   // with which the current ray was sampled, per solid angle
  bool weigh_ = false;   // whether light sampling could have found what the current ray hits
  float eta_scale_ = 1;  // radiance is compressed inside denser media; roulette looks at what will leave them
  ReferencePoint previous_;  // where the current ray started
};

SampledSpectrum Path::Trace() {
  int interfaces = 0;
  for (;;) {
    Hit hit;
    (depth_ == 0 ? counts_.camera : counts_.bounce) += 1;
    if (!world_.accelerator->Intersect(ray_, &hit)) {
      AddInfiniteLights();
      break;
    }
    SurfaceInteraction interaction = MakeInteraction(world_.geometry, hit, ray_);
    if (interaction.area_light >= 0) AddEmission(interaction);
    if (world_.materials.IsInterface(interaction.material)) {
      if (++interfaces > kInterfacesMax) break;
      ray_ = interaction.SpawnRay(ray_.d);
      continue;
    }
    if (depth_++ == settings_.max_depth) break;
    const Bsdf bsdf = BsdfAt(world_, settings_, interaction, wavelengths_);
    if (bsdf.HasNonSpecular()) radiance_ += throughput_ * DirectLight(interaction, bsdf);
    if (!Scatter(interaction, bsdf) || !SurvivesRoulette()) break;
  }
  return radiance_;
}

void Path::AddInfiniteLights() {
  for (int light : world_.lights.infinite_lights()) {
    const SampledSpectrum emitted = world_.lights.InfiniteRadiance(light, ray_.d, wavelengths_);
    const float weight =
        weigh_ ? PowerHeuristic(bsdf_pdf_, InfiniteLightPdf(world_, previous_, ray_.d, light)) : 1;
    radiance_ += throughput_ * emitted * weight;
  }
}

void Path::AddEmission(const SurfaceInteraction& interaction) {
  const SampledSpectrum emitted =
      world_.lights.EmittedRadiance(interaction.area_light, interaction, -ray_.d, wavelengths_);
  if (!AnyNonZero(emitted)) return;
  const float weight =
      weigh_ ? PowerHeuristic(bsdf_pdf_, EmitterPdf(world_, previous_, ray_.d, interaction)) : 1;
  radiance_ += throughput_ * emitted * weight;
}

SampledSpectrum Path::DirectLight(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const std::optional<SampledLight> sampled =
      SampleOneLight(world_, ReferenceAt(interaction), wavelengths_, sampler_);
  if (!sampled) return SampledSpectrum(0.0f);
  const LightSample& light = sampled->light;
  const BsdfEvaluation evaluation = bsdf.Evaluate(interaction.wo, light.wi);
  if (!AnyNonZero(evaluation.f)) return SampledSpectrum(0.0f);
  const Ray shadow = SpawnRayTo(interaction.p, interaction.p_error, interaction.n, light.p, light.p_error,
                                light.n, interaction.time);
  ++counts_.shadow;
  if (world_.accelerator->Occluded(shadow)) return SampledSpectrum(0.0f);
  const float weight = light.is_delta ? 1 : PowerHeuristic(sampled->pdf, evaluation.pdf);
  return evaluation.f * light.L * (AbsDot(light.wi, interaction.shading.n) * weight / sampled->pdf);
}

// Chooses the next direction; false if the light is absorbed.
bool Path::Scatter(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const float u_component = sampler_.Get1D();
  const Point2 u_direction = sampler_.Get2D();
  const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u_direction);
  if (!sample) return false;
  throughput_ *= sample->f * (AbsDot(sample->wi, interaction.shading.n) / sample->pdf);
  bsdf_pdf_ = sample->pdf;
  weigh_ = !sample->IsSpecular();
  if (sample->IsTransmission()) eta_scale_ *= Sqr(sample->eta);
  previous_ = ReferenceAt(interaction);
  ray_ = interaction.SpawnRay(sample->wi);
  return true;
}

// Ends paths of little throughput with a probability that keeps the mean.
bool Path::SurvivesRoulette() {
  const float end_probability = EndProbability(MaxElement(throughput_) * eta_scale_, depth_);
  if (end_probability > 0) {
    if (sampler_.Get1D() < end_probability) return false;
    throughput_ /= 1 - end_probability;
  }
  return true;
}

}  // namespace

SampledSpectrum PathRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                             SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  return Path(world, settings, camera_ray, wavelengths, sampler, counts).Trace();
}

}  // namespace tessera
