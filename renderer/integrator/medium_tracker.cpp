#include "renderer/integrator/medium_tracker.h"

#include "renderer/integrator/path_vertex.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {

void MediumTracker::Attenuate(const Ray& shadow, int medium, float t, PathWeights* weights) {
  if (medium < 0) return;
  FlightRandom random(shadow);
  Dispatch(In(medium), [&](const auto& coefficients) {
    FlyShadow(coefficients.RayAlong(shadow), t * Length(shadow.d), random, weights);
  });
}

bool MediumTracker::Reaches(Ray shadow, int medium, const LightSample& light, PathWeights* weights) {
  const World& world = context_.world;
  if (!world.has_interfaces) {
    ++context_.counts.shadow;
    if (world.accelerator->Occluded(shadow)) return false;
    Attenuate(shadow, medium, shadow.t_max, weights);
    return true;
  }
  // From interface to interface. Occluded must not be called first: transparent surfaces decide at random
  // whether a ray hits them, so that a second test could give another answer.
  for (int interfaces = 0; interfaces < kInterfacesMax; ++interfaces) {
    Hit hit;
    ++context_.counts.shadow;
    const bool found = world.accelerator->Intersect(shadow, &hit);
    const bool is_stopped =
        found && ShapeOf(world.geometry, hit.instance, hit.shape).surface.StopsShadowRays();
    if (is_stopped) return false;
    Attenuate(shadow, medium, found ? hit.t : shadow.t_max, weights);
    if (!found) return true;
    const SurfaceInteraction interaction = MakeInteraction(world.geometry, hit, shadow);
    if (world.materials.IsInterface(interaction.material)) medium = Beyond(interaction, shadow.d, medium);
    shadow = SpawnRayTo(interaction.p, interaction.p_error, interaction.n, light.p, light.p_error, light.n,
                        shadow.time);
  }
  return false;
}

}  // namespace tessera
