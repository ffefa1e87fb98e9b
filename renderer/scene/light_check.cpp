#include "renderer/scene/light_check.h"

namespace tessera {
namespace {

bool HasShadowRays(const Estimator& estimator) {
  return estimator.integrator.has_shadow_rays && estimator.techniques.sample_lights;
}

struct UnseenLight {
  const SourceLocation* location;
  std::string name;  // for messages
};

std::vector<UnseenLight> UnseenLights(const SceneDescription& scene, const Geometry& geometry) {
  std::vector<UnseenLight> unseen;
  for (const LightDescription& light : scene.lights) {
    if (light.entity.kind != "infinite")
      unseen.push_back({&light.entity.location, "light \"" + light.entity.kind + "\""});
  }
  for (const Shape& shape : geometry.shapes) {
    const FloatInput& alpha = shape.surface.alpha;
    if (shape.surface.area_light < 0 || !alpha.IsConstant() || alpha.constant > 0) continue;
    const std::optional<Entity>& light = scene.shapes[static_cast<size_t>(shape.description)].area_light;
    if (light) unseen.push_back({&light->location, "the area light of a shape of alpha 0"});
  }
  return unseen;
}

}  // namespace

Result<void> CheckLightsFor(const Estimator& estimator, const SceneDescription& scene,
                            const Geometry& geometry, Diagnostics& diagnostics) {
  if (HasShadowRays(estimator)) return {};
  for (const UnseenLight& light : UnseenLights(scene, geometry)) {
    const std::string what = light.name + " cannot be hit by rays, and this integrator has no shadow rays";
    if (estimator.integrator.kind == IntegratorKind::kMixture) {
      return ErrorAt(*light.location, what + ": \"mixture\" cannot render it (\"path\" can)");
    }
    diagnostics.Warn(*light.location, what + ": it stays dark");
  }
  return {};
}

}  // namespace tessera
