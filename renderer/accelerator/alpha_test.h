// Opacity of surfaces.
#pragma once

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Whether `ray` (rendering space) is stopped by the surface at `hit`: always where alpha is 1, never where it
// is 0, and with probability alpha in between. A hash decides, of the ray, the primitive and `crossing`,
// which counts the crossings of ray and primitive, so that layers stop a ray independently of each other.
// (pbrt hashes the ray alone: two layers of the same alpha stop it both or not at all.)
bool AlphaIsHit(const Geometry& geometry, const TextureTable& textures, const Ray& ray,
                const FloatInput& alpha, const Hit& hit, int crossing);

// Whether no ray can ever meet the shape.
inline bool IsNeverHit(const Shape& shape) {
  return shape.PrimitiveCount() == 0 ||
         (shape.surface.alpha.IsConstant() && shape.surface.alpha.constant <= 0);
}

}  // namespace tessera
