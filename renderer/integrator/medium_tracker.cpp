#include "renderer/integrator/medium_tracker.h"

#include "renderer/integrator/path_vertex.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {

void MediumTracker::Attenuate(const Ray& shadow, int medium, float t, PathWeights* weights) {
  if (medium < 0) return;
  FlightRandom random(shadow, 0.5f);
  FlyShadow(HomogeneousRay(In(medium)), t * Length(shadow.d), random, weights);
}

bool MediumTracker::Reaches(Ray shadow, int medium, const LightSample& light, PathWeights* weights) {
  if (!world_.has_interfaces) {
    ++counts_.shadow;
    if (world_.accelerator->Occluded(shadow)) return false;
    Attenuate(shadow, medium, shadow.t_max, weights);
    return true;
  }
  // From interface to interface. Not Occluded first: transparent surfaces decide by chance whether they are
  // hit, and must not be asked twice.
  for (int interfaces = 0; interfaces < kInterfacesMax; ++interfaces) {
    Hit hit;
    ++counts_.shadow;
    const bool found = world_.accelerator->Intersect(shadow, &hit);
    if (found && !ShapeOf(world_.geometry, hit.instance, hit.shape).surface.is_interface) return false;
    Attenuate(shadow, medium, found ? hit.t : shadow.t_max, weights);
    if (!found) return true;
    const SurfaceInteraction interaction = MakeInteraction(world_.geometry, hit, shadow);
    medium = Beyond(interaction, shadow.d, medium);
    shadow = SpawnRayTo(interaction.p, interaction.p_error, interaction.n, light.p, light.p_error, light.n,
                        shadow.time);
  }
  return false;
}

}  // namespace tessera
