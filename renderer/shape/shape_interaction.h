// From a hit to the local geometry of the surface.
#pragma once

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The interaction of `ray` (rendering space) with the surface that `hit` names. Also fills material, light
// and media.
SurfaceInteraction MakeInteraction(const Geometry& geometry, const Hit& hit, const Ray& ray);

// Position and texture coordinates alone: what an alpha test needs.
struct HitPoint {
  Point3 p;
  Point2 uv;
  Normal3 n;  // geometric, unit
};
HitPoint MakeHitPoint(const Geometry& geometry, const Hit& hit, const Ray& ray);

}  // namespace tessera
