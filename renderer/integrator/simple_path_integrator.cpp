#include "renderer/integrator/simple_path_integrator.h"

#include "renderer/integrator/light_walk.h"
#include "renderer/integrator/path_vertex.h"
#include "renderer/math/sampling.h"

namespace tessera {
namespace {

template <typename Sink>
class SimplePath {
 public:
  SimplePath(const PathContext& context, SimplePathTechniques techniques, const Ray& camera_ray, Sink& sink)
      : context_(context), techniques_(techniques), walk_(context, camera_ray, sink) {}

  void Trace();

 private:
  using Event = typename LightWalk<Sink>::Event;

  // Each returns false if the path ends.
  bool ScatterInMedium();
  bool ScatterOnSurface();
  bool ScatterByBsdf(const Bsdf& bsdf);
  bool ScatterUniformly(const Bsdf& bsdf);

  void AddInfiniteEmission();
  void AddSurfaceEmission();
  void AddDirectLight(const Bsdf& bsdf);

  const PathContext& context_;
  const SimplePathTechniques techniques_;
  LightWalk<Sink> walk_;
  bool light_was_sampled_ = false;  // where the current ray started
  ReferencePoint previous_;         // that place
};

template <typename Sink>
void SimplePath<Sink>::Trace() {
  for (;;) {
    const Event event = walk_.Advance();
    if (event == Event::kEscaped) AddInfiniteEmission();
    if (event == Event::kOnSurface) AddSurfaceEmission();
    if (walk_.EndsAt(event)) return;
    const bool scattered = event == Event::kInMedium ? ScatterInMedium() : ScatterOnSurface();
    if (!scattered) return;
  }
}

template <typename Sink>
bool SimplePath<Sink>::ScatterInMedium() {
  const PhaseSample sample = walk_.phase().Sample(-walk_.ray.d, context_.sampler.Get2D());
  light_was_sampled_ = false;
  walk_.Leave({walk_.ray.o, sample.wi, std::numeric_limits<float>::infinity(), walk_.ray.time},
              SampledSpectrum(1.0f), {FirstScatter::kMedium}, false);
  return true;
}

template <typename Sink>
bool SimplePath<Sink>::ScatterOnSurface() {
  const Bsdf bsdf = walk_.Scatterer();
  light_was_sampled_ = techniques_.sample_lights && bsdf.HasNonSpecular();
  previous_ = ReferenceAt(walk_.interaction);
  if (light_was_sampled_) AddDirectLight(bsdf);
  return techniques_.sample_bsdf ? ScatterByBsdf(bsdf) : ScatterUniformly(bsdf);
}

// Light from directions that light sampling never takes is found by the rays that miss.
template <typename Sink>
void SimplePath<Sink>::AddInfiniteEmission() {
  const Vec3 d = walk_.ray.d;
  for (const int light : context_.world.lights.infinite_lights()) {
    if (light_was_sampled_ && (InfiniteLightPdf(context_.world, previous_, d, light) > 0 ||
                               !context_.world.links.CastsShadows(light)))
      continue;
    walk_.AddInfiniteEmission(light);
  }
}

template <typename Sink>
void SimplePath<Sink>::AddSurfaceEmission() {
  if (walk_.interaction.area_light < 0) return;
  if (light_was_sampled_ && (EmitterPdf(context_.world, previous_, walk_.ray.d, walk_.interaction) > 0 ||
                             !context_.world.links.CastsShadows(walk_.interaction.area_light)))
    return;
  walk_.AddSurfaceEmission();
}

template <typename Sink>
void SimplePath<Sink>::AddDirectLight(const Bsdf& bsdf) {
  const std::optional<SampledLight> sampled = SampleOneLight(context_, previous_);
  if (!sampled) return;
  const LightSample& light = sampled->light;
  const SurfaceInteraction& here = walk_.interaction;
  const SampledSpectrum f = bsdf.Evaluate(here.wo, light.wi).f;
  if (!AnyNonZero(f)) return;
  ++context_.counts.shadow;
  const SampledSpectrum scattered =
      f * light.Radiance(context_.wavelengths) * (AbsDot(light.wi, here.shading.n) / sampled->pdf);
  if (sampled->casts_shadows && context_.world.accelerator->Occluded(ShadowRay(here, light)))
    return walk_.AddShadow(scattered);
  walk_.AddLight(scattered, sampled->index, walk_.VertexOf(bsdf, light.wi, false));
}

template <typename Sink>
bool SimplePath<Sink>::ScatterByBsdf(const Bsdf& bsdf) {
  const SurfaceInteraction& interaction = walk_.interaction;
  const float u_component = context_.sampler.Get1D();
  const Point2 u_direction = context_.sampler.Get2D();
  const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u_direction);
  if (!sample) return false;
  if (sample->IsSpecular()) light_was_sampled_ = false;
  const float cosine = AbsDot(sample->wi, interaction.shading.n);
  walk_.Leave(interaction.SpawnRay(sample->wi), sample->f * (cosine / sample->pdf),
              walk_.VertexOf(bsdf, sample->wi, sample->IsSpecular()), sample->IsSpecular());
  return true;
}

// Over the sphere if the surface both reflects and transmits, else over the hemisphere into which it
// scatters.
template <typename Sink>
bool SimplePath<Sink>::ScatterUniformly(const Bsdf& bsdf) {
  const SurfaceInteraction& interaction = walk_.interaction;
  const Point2 u = context_.sampler.Get2D();
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
  walk_.Leave(interaction.SpawnRay(wi), f * (AbsDot(wi, interaction.shading.n) / pdf),
              walk_.VertexOf(bsdf, wi, false), false);
  return true;
}

}  // namespace

template <typename Sink>
void TraceSimplePath(const PathContext& context, SimplePathTechniques techniques, const Ray& camera_ray,
                     Sink& sink) {
  SimplePath<Sink>(context, techniques, camera_ray, sink).Trace();
}

template void TraceSimplePath(const PathContext&, SimplePathTechniques, const Ray&, RadianceSink&);
template void TraceSimplePath(const PathContext&, SimplePathTechniques, const Ray&, RecordingSink&);

}  // namespace tessera
