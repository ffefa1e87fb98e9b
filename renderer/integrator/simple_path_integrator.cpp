#include "renderer/integrator/simple_path_integrator.h"

#include "renderer/integrator/light_walk.h"
#include "renderer/integrator/path_vertex.h"
#include "renderer/math/sampling.h"

namespace tessera {
namespace {

class SimplePath {
 public:
  SimplePath(const World& world, const SimplePathSettings& settings, const Ray& camera_ray,
             SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts)
      : world_(world),
        settings_(settings),
        walk_(world, camera_ray, wavelengths, counts),
        wavelengths_(wavelengths),
        sampler_(sampler),
        counts_(counts) {}

  SampledSpectrum Trace();

 private:
  // Each false if the path ends.
  bool ScatterInMedium();
  bool ScatterOnSurface();
  bool ScatterByBsdf(const Bsdf& bsdf);
  bool ScatterUniformly(const Bsdf& bsdf);

  void AddInfiniteEmission();
  void AddSurfaceEmission();
  SampledSpectrum DirectLight(const Bsdf& bsdf);

  const World& world_;
  const SimplePathSettings& settings_;
  LightWalk walk_;
  SampledWavelengths& wavelengths_;
  Sampler& sampler_;
  RayCounts& counts_;
  bool light_was_sampled_ = false;  // where the current ray started
  ReferencePoint previous_;         // that place
};

SampledSpectrum SimplePath::Trace() {
  for (int depth = 0;; ++depth) {
    const LightWalk::Event event = walk_.Advance(sampler_);
    if (event == LightWalk::Event::kEscaped) AddInfiniteEmission();
    if (event == LightWalk::Event::kOnSurface) AddSurfaceEmission();
    if (event == LightWalk::Event::kEscaped || depth == settings_.path.max_depth) return walk_.radiance;
    const bool scattered = event == LightWalk::Event::kInMedium ? ScatterInMedium() : ScatterOnSurface();
    if (!scattered) return walk_.radiance;
  }
}

bool SimplePath::ScatterInMedium() {
  const PhaseSample sample = walk_.phase().Sample(-walk_.ray.d, sampler_.Get2D());
  light_was_sampled_ = false;
  walk_.Leave({walk_.ray.o, sample.wi, std::numeric_limits<float>::infinity(), walk_.ray.time},
              SampledSpectrum(1.0f));
  return true;
}

bool SimplePath::ScatterOnSurface() {
  const Bsdf bsdf = walk_.Scatterer(settings_.path);
  light_was_sampled_ = settings_.sample_lights && bsdf.HasNonSpecular();
  previous_ = ReferenceAt(walk_.interaction);
  if (light_was_sampled_) walk_.radiance += walk_.throughput * DirectLight(bsdf);
  return settings_.sample_bsdf ? ScatterByBsdf(bsdf) : ScatterUniformly(bsdf);
}

// Directions that light sampling never takes are left to the rays that miss.
void SimplePath::AddInfiniteEmission() {
  const Vec3 d = walk_.ray.d;
  for (const int light : world_.lights.infinite_lights()) {
    if (light_was_sampled_ && InfiniteLightPdf(world_, previous_, d, light) > 0) continue;
    walk_.radiance += walk_.throughput * world_.lights.InfiniteRadiance(light, d, wavelengths_);
  }
}

void SimplePath::AddSurfaceEmission() {
  if (walk_.interaction.area_light < 0) return;
  if (light_was_sampled_ && EmitterPdf(world_, previous_, walk_.ray.d, walk_.interaction) > 0) return;
  walk_.AddSurfaceEmission();
}

SampledSpectrum SimplePath::DirectLight(const Bsdf& bsdf) {
  const std::optional<SampledLight> sampled = SampleOneLight(world_, previous_, wavelengths_, sampler_);
  if (!sampled) return SampledSpectrum(0.0f);
  const LightSample& light = sampled->light;
  const SurfaceInteraction& here = walk_.interaction;
  const SampledSpectrum f = bsdf.Evaluate(here.wo, light.wi).f;
  if (!AnyNonZero(f)) return SampledSpectrum(0.0f);
  const Ray shadow = SpawnRayTo(here.p, here.p_error, here.n, light.p, light.p_error, light.n, here.time);
  ++counts_.shadow;
  if (world_.accelerator->Occluded(shadow)) return SampledSpectrum(0.0f);
  return f * light.L * (AbsDot(light.wi, here.shading.n) / sampled->pdf);
}

bool SimplePath::ScatterByBsdf(const Bsdf& bsdf) {
  const SurfaceInteraction& interaction = walk_.interaction;
  const float u_component = sampler_.Get1D();
  const Point2 u_direction = sampler_.Get2D();
  const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u_direction);
  if (!sample) return false;
  if (sample->IsSpecular()) light_was_sampled_ = false;
  const float cosine = AbsDot(sample->wi, interaction.shading.n);
  walk_.Leave(interaction.SpawnRay(sample->wi), sample->f * (cosine / sample->pdf));
  return true;
}

// Over the sphere if the surface both reflects and transmits, else over the hemisphere into which it
// scatters.
bool SimplePath::ScatterUniformly(const Bsdf& bsdf) {
  const SurfaceInteraction& interaction = walk_.interaction;
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
  walk_.Leave(interaction.SpawnRay(wi), f * (AbsDot(wi, interaction.shading.n) / pdf));
  return true;
}

}  // namespace

SampledSpectrum SimplePathRadiance(const World& world, const SimplePathSettings& settings,
                                   const Ray& camera_ray, SampledWavelengths& wavelengths, Sampler& sampler,
                                   RayCounts& counts) {
  return SimplePath(world, settings, camera_ray, wavelengths, sampler, counts).Trace();
}

}  // namespace tessera
