// Rays of several lanes with what they hit.
#pragma once

#include "renderer/math/lanes.h"
#include "renderer/math/ray.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// Rays, and what each of them hits.
struct HitLanes {
  const Ray* rays[kLanes];
  Hit hits[kLanes];
};

// Surface points with their normals, as those of SurfaceInteraction.
struct SurfacePoints8 {
  Vec3x8 p, p_error, n, shading_n;
};

}  // namespace tessera
