#include "renderer/integrator/path_vertex.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {
namespace {

// Whether a scattered ray to the light would end at a surface that shadow rays pass, if nothing else is in
// the way.
bool StopsScatteredRays(const PathContext& context, const ReferencePoint& from, const LightSample& light) {
  const World& world = context.world;
  Ray ray = SpawnRayTo(from.p, from.p_error, from.n, light.p, light.p_error, light.n, from.time);
  for (int passed = 0; passed < kInterfacesMax; ++passed) {
    Hit hit;
    ++context.counts.shadow;
    if (!world.accelerator->Intersect(ray, &hit)) return false;
    const SurfaceProperties& surface = ShapeOf(world.geometry, hit.instance, hit.shape).surface;
    if (!surface.is_interface && (surface.hidden_from & kHiddenFromIndirect) == 0) return true;
    const SurfaceInteraction at = MakeInteraction(world.geometry, hit, ray);
    ray = SpawnRayTo(at.p, at.p_error, at.n, light.p, light.p_error, light.n, ray.time);
  }
  return true;
}

}  // namespace

bool FollowLink(const PathContext& context, const ReferencePoint& from, SampledLight& sampled) {
  const LightLinks& links = context.world.links;
  if (!links.Illuminates(sampled.index, from.light_links)) return false;
  sampled.casts_shadows = links.CastsShadows(sampled.index);
  LightSample& light = sampled.light;
  if (!sampled.casts_shadows) light.is_delta = true;
  if (links.any_passed() && !light.is_delta) light.is_delta = StopsScatteredRays(context, from, light);
  return true;
}

}  // namespace tessera
