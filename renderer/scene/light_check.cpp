#include "renderer/scene/light_check.h"

namespace tessera {
namespace {

struct UnseenLight {
  const SourceLocation* location;
  std::string name;  // for messages
};

std::vector<UnseenLight> UnseenLights(const SceneDescription& scene,
                                      const std::vector<EmittingShape>& emitters, const World& world) {
  std::vector<UnseenLight> unseen;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Entity& light = scene.lights[i].entity;
    if (!world.lights.IsHitByRays(static_cast<int>(i)))
      unseen.push_back({&light.location, "light \"" + light.kind + "\""});
  }
  for (const EmittingShape& emitter : emitters) {
    const int light = ShapeOf(world.geometry, emitter.instance, emitter.shape).surface.area_light;
    if (light >= 0 && !world.lights.IsHitByRays(light))
      unseen.push_back({&emitter.description->area_light->location, "the area light of a shape of alpha 0"});
  }
  return unseen;
}

}  // namespace

Result<void> CheckLightsFor(const Estimator& estimator, const SceneDescription& scene,
                            const std::vector<EmittingShape>& emitters, const World& world,
                            Diagnostics& diagnostics) {
  if (estimator.HasShadowRays()) return {};
  if (world.links.any_passed() || world.links.any_without_shadows()) {
    diagnostics.Warn(scene.integrator.location,
                     "\"visible_shadow\" and \"cast_shadows\" have no effect: this integrator traces no "
                     "shadow rays");
  }
  for (const UnseenLight& light : UnseenLights(scene, emitters, world)) {
    const std::string what = "no ray can hit " + light.name + ", and this integrator traces no shadow rays";
    if (estimator.integrator.kind == IntegratorKind::kMixture) {
      return ErrorAt(*light.location, what + "; use \"path\"");
    }
    diagnostics.Warn(*light.location, what + ": it has no effect");
  }
  return {};
}

}  // namespace tessera
