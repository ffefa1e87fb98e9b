// Gives a hit the same bits on every machine. Ray tracing kernels divide by approximate reciprocals that
// differ between makes of processors; the parts of a hit that reach the picture are therefore computed here,
// from the primitive that was found.
#pragma once

#include "renderer/shape/double3.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// `ray` in the space of the instance's group at the time of the ray; unchanged without an instance.
inline DoubleRay RayInShapeSpace(const Geometry& geometry, uint32_t instance, const Ray& ray) {
  const InstancePlace place(geometry, instance, ray.time);
  return HitRay{ray, place.render_from_group()}.InShapeSpace();
}

// Recomputes t, u and v of a hit on a triangle, or on a patch that is a parallelogram, in double precision;
// other hits are left as they are. Returns false if the true distance is not positive: then the ray starts
// on or beyond the surface, and the hit is a rounding error of the kernel.
bool RefineHit(const Geometry& geometry, const Ray& ray, Hit* hit);

}  // namespace tessera
