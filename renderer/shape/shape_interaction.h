// From a hit to the local geometry of the surface.
#pragma once

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// The interaction of `ray` (rendering space) with the surface that `hit` names, with its material, light and
// media.
SurfaceInteraction MakeInteraction(const Geometry& geometry, const Hit& hit, const Ray& ray);

// The part of it that an alpha test needs.
HitPoint MakeHitPoint(const Geometry& geometry, const Hit& hit, const Ray& ray);

}  // namespace tessera
