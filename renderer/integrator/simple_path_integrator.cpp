#include "integrator/simple_path_integrator.h"

#include "integrator/emission_on_hit.h"
#include "integrator/texture_context.h"
#include "math/sampling.h"

namespace tessera {
namespace {

ReferencePoint ReferenceAt(const SurfaceInteraction& interaction) {
  return {interaction.p, interaction.p_error, interaction.n, interaction.shading.n};
}

class SimplePath {
 public:
  SimplePath(const World& world, const SimplePathSettings& settings, const Ray& camera_ray,
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
  bool ScatterByBsdf(const SurfaceInteraction& interaction, const Bsdf& bsdf);
  bool ScatterUniformly(const SurfaceInteraction& interaction, const Bsdf& bsdf);

  const World& world_;
  const SimplePathSettings& settings_;
  Ray ray_;
  SampledWavelengths& wavelengths_;
  Sampler& sampler_;
  RayCounts& counts_;
  SampledSpectrum radiance_{0.0f}, throughput_{1.0f};
  bool light_was_sampled_ = false;  // where the current ray started
  ReferencePoint previous_;         // that place
};

SampledSpectrum SimplePath::Trace() {
  for (int depth = 0;; ++depth) {
    auto interaction = FollowRay(world_, ray_, depth == 0 ? counts_.camera : counts_.bounce);
    if (!interaction) {
      AddInfiniteLights();
      return radiance_;
    }
    AddEmission(*interaction);
    if (depth == settings_.path.max_depth) return radiance_;
    const TextureContext context =
        MakeTextureContext(*interaction, world_.camera, settings_.path.footprint_scale);
    const Bsdf bsdf = world_.materials.Evaluate(interaction->material, world_.textures, context, *interaction,
                                                wavelengths_);
    light_was_sampled_ = settings_.sample_lights && bsdf.HasNonSpecular();
    previous_ = ReferenceAt(*interaction);
    if (light_was_sampled_) radiance_ += throughput_ * DirectLight(*interaction, bsdf);
    const bool scattered =
        settings_.sample_bsdf ? ScatterByBsdf(*interaction, bsdf) : ScatterUniformly(*interaction, bsdf);
    if (!scattered) return radiance_;
  }
}

// Directions that light sampling never takes are left to the rays that miss.
void SimplePath::AddInfiniteLights() {
  for (const int light : world_.lights.infinite_lights()) {
    const bool is_found = light_was_sampled_ && world_.lights.InfiniteLightPdf(light, ray_.d) > 0 &&
                          world_.lights.ChoosePmf(previous_, light) > 0;
    if (!is_found) radiance_ += throughput_ * world_.lights.InfiniteRadiance(light, ray_.d, wavelengths_);
  }
}

void SimplePath::AddEmission(const SurfaceInteraction& interaction) {
  const int light = interaction.area_light;
  if (light < 0) return;
  const bool is_found = light_was_sampled_ &&
                        world_.lights.AreaLightPdf(light, previous_, ray_.d, interaction) > 0 &&
                        world_.lights.ChoosePmf(previous_, light) > 0;
  if (!is_found) radiance_ += throughput_ * EmissionAt(world_, interaction, wavelengths_);
}

SampledSpectrum SimplePath::DirectLight(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const float u_choice = sampler_.Get1D();
  const Point2 u_light = sampler_.Get2D();
  const std::optional<ChosenLight> chosen = world_.lights.Choose(previous_, u_choice);
  if (!chosen) return SampledSpectrum(0.0f);
  const std::optional<LightSample> light =
      world_.lights.Sample(chosen->light, previous_, u_light, wavelengths_);
  if (!light || light->pdf <= 0) return SampledSpectrum(0.0f);
  const SampledSpectrum f = bsdf.Evaluate(interaction.wo, light->wi).f;
  if (!AnyNonZero(f) || !AnyNonZero(light->L)) return SampledSpectrum(0.0f);
  const Ray shadow = SpawnRayTo(interaction.p, interaction.p_error, interaction.n, light->p, light->p_error,
                                light->n, interaction.time);
  ++counts_.shadow;
  if (world_.accelerator->Occluded(shadow)) return SampledSpectrum(0.0f);
  return f * light->L * (AbsDot(light->wi, interaction.shading.n) / (chosen->pmf * light->pdf));
}

bool SimplePath::ScatterByBsdf(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const float u_component = sampler_.Get1D();
  const Point2 u_direction = sampler_.Get2D();
  const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u_direction);
  if (!sample) return false;
  throughput_ *= sample->f * (AbsDot(sample->wi, interaction.shading.n) / sample->pdf);
  if (sample->IsSpecular()) light_was_sampled_ = false;
  ray_ = interaction.SpawnRay(sample->wi);
  return true;
}

// Over the sphere if the surface both reflects and transmits, else over the hemisphere into which it
// scatters.
bool SimplePath::ScatterUniformly(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const Point2 u = sampler_.Get2D();
  const bool reflects = HasFlag(bsdf.flags(), BxdfFlags::kReflection);
  const bool transmits = HasFlag(bsdf.flags(), BxdfFlags::kTransmission);
  Vec3 wi = SampleUniformSphere(u);
  float pdf = UniformSpherePdf();
  if (reflects != transmits) {
    pdf = UniformHemispherePdf();
    const bool reflected = Dot(wi, interaction.n) * Dot(interaction.wo, interaction.n) > 0;
    if (reflected != reflects) wi = -wi;
  }
  const SampledSpectrum f = bsdf.Evaluate(interaction.wo, wi).f;
  if (!AnyNonZero(f)) return false;
  throughput_ *= f * (AbsDot(wi, interaction.shading.n) / pdf);
  ray_ = interaction.SpawnRay(wi);
  return true;
}

}  // namespace

SampledSpectrum SimplePathRadiance(const World& world, const SimplePathSettings& settings,
                                   const Ray& camera_ray, SampledWavelengths& wavelengths, Sampler& sampler,
                                   RayCounts& counts) {
  return SimplePath(world, settings, camera_ray, wavelengths, sampler, counts).Trace();
}

}  // namespace tessera
