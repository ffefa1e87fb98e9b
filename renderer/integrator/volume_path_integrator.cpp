#include "renderer/integrator/volume_path_integrator.h"

#include "renderer/integrator/medium_tracker.h"
#include "renderer/integrator/path_vertex.h"
#include "renderer/math/sampling.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {
namespace {

// One path from the camera, extended ray by ray.
class VolumePath {
 public:
  VolumePath(const World& world, const PathSettings& settings, const Ray& camera_ray,
             SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts)
      : world_(world),
        settings_(settings),
        ray_(camera_ray),
        medium_(world.camera_medium),
        wavelengths_(wavelengths),
        sampler_(sampler),
        counts_(counts),
        tracker_(world, wavelengths, counts) {}

  SampledSpectrum Trace();

 private:
  // Each is false if the path ends.
  bool Extend();
  bool ScatterInMedium(float t);
  bool ScatterOnSurface(SurfaceInteraction& interaction);
  bool SampleDirection(const SurfaceInteraction& interaction, const Bsdf& bsdf);
  bool SurvivesRoulette();

  FlightEnd FlyTo(float t_max, float u, float* t_event);
  void AddInfiniteLights();
  void AddEmission(const SurfaceInteraction& interaction);
  void AddSurfaceLight(const SurfaceInteraction& interaction, const Bsdf& bsdf);
  void AddMediumLight(Vec3 wo, const PhaseFunction& phase);
  void AddLight(const SampledLight& sampled, const Ray& shadow, int medium, SampledSpectrum f, float pdf);
  void AddHit(SampledSpectrum emitted, float light_pdf);
  void FollowFirstWavelength();

  const World& world_;
  const PathSettings& settings_;
  Ray ray_;
  int medium_;  // of the current ray
  SampledWavelengths& wavelengths_;
  Sampler& sampler_;
  RayCounts& counts_;
  MediumTracker tracker_;
  SampledSpectrum radiance_{0.0f};
  PathWeights weights_;
  SampledSpectrum counted_{1.0f};  // what each wavelength stands for in radiance_: see FollowFirstWavelength
  int depth_ = 0, interfaces_ = 0;
  bool weigh_ = false;   // whether light sampling could have found what the current ray hits
  float eta_scale_ = 1;  // radiance is compressed inside denser media; roulette looks at what will leave them
  ReferencePoint previous_;  // where the current ray started
};

SampledSpectrum VolumePath::Trace() {
  const Float4 pdf = wavelengths_.pdf;
  while (Extend()) {
  }
  wavelengths_.pdf = pdf;  // counted_ has seen to it
  return radiance_;
}

bool VolumePath::Extend() {
  float u = 0;
  if (medium_ >= 0) {
    const float sigma_s = tracker_.In(medium_).sigma_s[0];
    if (sigma_s > 0) {
      u = sampler_.Get1D();
      // What lies behind the first collision need not be found, unless the medium glows all the way to it.
      if (!world_.media[medium_].is_emissive())
        ray_.t_max = std::min(SampleExponential(u, sigma_s), kFlightMax);
    }
  }
  (depth_ == 0 ? counts_.camera : counts_.bounce) += 1;
  Hit hit;
  const bool found = world_.accelerator->Intersect(ray_, &hit);
  if (medium_ >= 0) {
    float t_event = 0;
    const FlightEnd end = FlyTo(found ? hit.t : std::numeric_limits<float>::infinity(), u, &t_event);
    if (end == FlightEnd::kAbsorbed) return false;
    if (end == FlightEnd::kScattered) return ScatterInMedium(t_event);
  }
  if (!found) {
    AddInfiniteLights();
    return false;
  }
  SurfaceInteraction interaction = MakeInteraction(world_.geometry, hit, ray_);
  if (interaction.area_light >= 0) AddEmission(interaction);
  if (world_.materials.IsInterface(interaction.material)) {
    medium_ = MediumTracker::Beyond(interaction, ray_.d, medium_);
    ray_ = interaction.SpawnRay(ray_.d);
    return ++interfaces_ <= kInterfacesMax;
  }
  return ScatterOnSurface(interaction);
}

FlightEnd VolumePath::FlyTo(float t_max, float u, float* t_event) {
  FlightRandom random(ray_, u);
  SampledSpectrum emitted(0.0f);
  const bool emits = depth_ < settings_.max_depth && world_.media[medium_].is_emissive();
  const FlightEnd end = Fly(HomogeneousRay(tracker_.In(medium_)), t_max, random, &weights_,
                            emits ? &emitted : nullptr, t_event);
  if (emits) radiance_ += counted_ * emitted;
  return end;
}

bool VolumePath::ScatterInMedium(float t) {
  if (depth_++ == settings_.max_depth) return false;
  interfaces_ = 0;
  const PhaseFunction& phase = world_.media[medium_].phase();
  const Vec3 wo = -ray_.d;
  previous_ = {ray_.At(t), {}, {}, {}};
  AddMediumLight(wo, phase);
  const PhaseSample sample = phase.Sample(wo, sampler_.Get2D());
  weights_.r_l = weights_.r_u / sample.pdf;  // beta does not change: the value is the density
  weigh_ = true;
  ray_ = {previous_.p, sample.wi, std::numeric_limits<float>::infinity(), ray_.time};
  return SurvivesRoulette();
}

bool VolumePath::ScatterOnSurface(SurfaceInteraction& interaction) {
  if (depth_++ == settings_.max_depth) return false;
  interfaces_ = 0;
  const bool had_all_wavelengths = !wavelengths_.SecondaryTerminated();
  const Bsdf bsdf = BsdfAt(world_, settings_, interaction, wavelengths_);
  if (had_all_wavelengths && wavelengths_.SecondaryTerminated()) FollowFirstWavelength();
  if (bsdf.HasNonSpecular()) AddSurfaceLight(interaction, bsdf);
  return SampleDirection(interaction, bsdf) && SurvivesRoulette();
}

// After dispersion the first wavelength alone decides and alone carries light, for all four. What was found
// before still counts at all of them: their densities relative to each other belong to paths that had not
// dispersed.
void VolumePath::FollowFirstWavelength() {
  counted_ = SampledSpectrum(4, 0, 0, 0);
  weights_.beta = SampledSpectrum(weights_.beta[0], 0, 0, 0);
  weights_.r_u = SampledSpectrum(weights_.r_u[0]);
  weights_.r_l = SampledSpectrum(weights_.r_l[0]);
  tracker_.Forget();
}

bool VolumePath::SampleDirection(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const float u_component = sampler_.Get1D();
  const Point2 u_direction = sampler_.Get2D();
  const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u_direction);
  if (!sample) return false;
  weights_.beta *= sample->f * (AbsDot(sample->wi, interaction.shading.n) / sample->pdf);
  weights_.r_l = weights_.r_u / sample->pdf;
  weigh_ = !sample->IsSpecular();
  if (sample->IsTransmission()) eta_scale_ *= Sqr(sample->eta);
  previous_ = ReferenceAt(interaction);
  ray_ = interaction.SpawnRay(sample->wi);
  medium_ = MediumTracker::Beyond(interaction, sample->wi, medium_);
  return true;
}

bool VolumePath::SurvivesRoulette() {
  const float end_probability = EndProbability(MaxElement(weights_.Throughput()) * eta_scale_, depth_);
  if (end_probability > 0) {
    if (sampler_.Get1D() < end_probability) return false;
    weights_.beta /= 1 - end_probability;
  }
  return true;
}

void VolumePath::AddInfiniteLights() {
  for (int light : world_.lights.infinite_lights()) {
    const SampledSpectrum emitted = world_.lights.InfiniteRadiance(light, ray_.d, wavelengths_);
    AddHit(emitted, weigh_ ? InfiniteLightPdf(world_, previous_, ray_.d, light) : 0);
  }
}

void VolumePath::AddEmission(const SurfaceInteraction& interaction) {
  const SampledSpectrum emitted =
      world_.lights.EmittedRadiance(interaction.area_light, interaction, -ray_.d, wavelengths_);
  if (!AnyNonZero(emitted)) return;
  AddHit(emitted, weigh_ ? EmitterPdf(world_, previous_, ray_.d, interaction) : 0);
}

// Light that the current ray hit, which light sampling finds with density light_pdf. Two levels of weights:
// the balance heuristic between the wavelengths that may decide, the power heuristic between the densities
// that this gives the two techniques.
void VolumePath::AddHit(SampledSpectrum emitted, float light_pdf) {
  const float path_pdf = Average(weights_.r_u);
  const float weight = PowerHeuristic(path_pdf, Average(weights_.r_l) * light_pdf);
  radiance_ += counted_ * weights_.beta * emitted * (weight / path_pdf);
}

void VolumePath::AddSurfaceLight(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  const std::optional<SampledLight> sampled =
      SampleOneLight(world_, ReferenceAt(interaction), wavelengths_, sampler_);
  if (!sampled) return;
  const LightSample& light = sampled->light;
  const BsdfEvaluation evaluation = bsdf.Evaluate(interaction.wo, light.wi);
  if (!AnyNonZero(evaluation.f)) return;
  const Ray shadow = SpawnRayTo(interaction.p, interaction.p_error, interaction.n, light.p, light.p_error,
                                light.n, interaction.time);
  AddLight(*sampled, shadow, MediumTracker::Beyond(interaction, light.wi, medium_),
           evaluation.f * AbsDot(light.wi, interaction.shading.n), evaluation.pdf);
}

void VolumePath::AddMediumLight(Vec3 wo, const PhaseFunction& phase) {
  const std::optional<SampledLight> sampled = SampleOneLight(world_, previous_, wavelengths_, sampler_);
  if (!sampled) return;
  const LightSample& light = sampled->light;
  const float value = phase.Evaluate(wo, light.wi);
  const Ray shadow = SpawnRayTo(previous_.p, {}, {}, light.p, light.p_error, light.n, ray_.time);
  AddLight(*sampled, shadow, medium_, SampledSpectrum(value), value);
}

// Light from a sampled light: f is what the vertex sends on, with its cosine, pdf the density of sampling
// that direction.
void VolumePath::AddLight(const SampledLight& sampled, const Ray& shadow, int medium, SampledSpectrum f,
                          float pdf) {
  PathWeights passage;
  if (!tracker_.Reaches(shadow, medium, sampled.light, &passage)) return;
  const float light_pdf = Average(weights_.r_u * passage.r_l) * sampled.pdf;
  const float path_pdf = Average(weights_.r_u * passage.r_u) * pdf;
  const float weight = sampled.light.is_delta ? 1 : PowerHeuristic(light_pdf, path_pdf);
  radiance_ += counted_ * weights_.beta * f * passage.beta * sampled.light.L * (weight / light_pdf);
}

}  // namespace

SampledSpectrum VolumePathRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                                   SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  return VolumePath(world, settings, camera_ray, wavelengths, sampler, counts).Trace();
}

}  // namespace tessera
