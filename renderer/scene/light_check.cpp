#include "renderer/scene/light_check.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

// The parts of a message.
struct UnseenLight {
  const SourceLocation* location;
  const char* rays;  // that cannot hit it
  std::string name;
};

std::vector<UnseenLight> UnseenLights(const SceneDescription& scene,
                                      const std::vector<EmittingShape>& emitters, const World& world) {
  std::vector<UnseenLight> unseen;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Entity& light = scene.lights[i].entity;
    if (!world.lights.IsHitByScatteredRays(static_cast<int>(i)))
      unseen.push_back({&light.location, "no ray", "light \"" + light.kind + "\""});
  }
  for (const EmittingShape& emitter : emitters) {
    const SurfaceProperties& surface = ShapeOf(world.geometry, emitter.instance, emitter.shape).surface;
    const int light = surface.area_light;
    if (light < 0 || world.lights.IsHitByScatteredRays(light)) continue;
    const SourceLocation* const location = &emitter.description->area_light->location;
    if (surface.hidden_from & kHiddenFromIndirect)
      unseen.push_back(
          {location, "no scattered ray", "the area light of a shape with \"visible_indirect\" false"});
    else
      unseen.push_back({location, "no ray", "the area light of a shape of alpha 0"});
  }
  return unseen;
}

// Whether the medium at the camera reaches infinitely far, as far as surfaces tell, and lets no ray through.
bool IsBoundless(const World& world) {
  const int medium = world.camera_medium;
  if (medium < 0 || world.media.empty()) return false;
  const MediumCoefficients coefficients = world.media[medium].At(SampledWavelengths::SampleVisible(0.5f));
  const auto* const homogeneous = std::get_if<HomogeneousCoefficients>(&coefficients);
  if (homogeneous == nullptr || !AnyNonZero(homogeneous->sigma_a + homogeneous->sigma_s)) return false;
  const auto borders_it = [medium](const Shape& shape) {
    const SurfaceProperties& surface = shape.surface;
    return (surface.inside_medium == medium) != (surface.outside_medium == medium);
  };
  const auto has_border = [&](const ShapeGroup& group) {
    return std::ranges::any_of(group.shapes, borders_it);
  };
  return std::ranges::none_of(world.geometry.shapes, borders_it) &&
         std::ranges::none_of(world.geometry.groups, has_border);
}

void WarnOfBoundlessMedium(const SceneDescription& scene, const World& world, Diagnostics& diagnostics) {
  if (world.lights.infinite_lights().empty() || !IsBoundless(world)) return;
  diagnostics.Warn(
      scene.camera.location,
      "the medium of the camera has no border: light from infinitely far away reaches nothing in "
      "it but by light sampling, which counts the medium up to twice the radius of the scene");
}

}  // namespace

Result<void> CheckLightsFor(const Estimator& estimator, const SceneDescription& scene,
                            const std::vector<EmittingShape>& emitters, const World& world,
                            Diagnostics& diagnostics) {
  WarnOfBoundlessMedium(scene, world, diagnostics);
  if (estimator.HasShadowRays()) return {};
  if (world.links.any_passed() || world.links.any_without_shadows()) {
    diagnostics.Warn(scene.integrator.location,
                     "\"visible_shadow\" and \"cast_shadows\" have no effect: this integrator traces no "
                     "shadow rays");
  }
  for (const UnseenLight& light : UnseenLights(scene, emitters, world)) {
    const std::string what =
        fmt::format("{} can hit {}, and this integrator traces no shadow rays", light.rays, light.name);
    if (estimator.integrator.draws_rays_to_lights) return ErrorAt(*light.location, what + "; use \"path\"");
    diagnostics.Warn(*light.location, what + ": it has no effect");
  }
  return {};
}

}  // namespace tessera
