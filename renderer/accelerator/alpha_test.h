// Surfaces that let some rays pass.
#pragma once

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Whether the surface at `hit` is there for this ray, given in rendering space: always where alpha is 1,
// never where it is 0, and in between with that probability, decided by a hash of the ray. Without regard to
// the primitive, as in pbrt: two layers of the same alpha on a ray's way are there both or not at all.
bool AlphaIsHit(const Geometry& geometry, const TextureTable& textures, const Ray& ray,
                const FloatInput& alpha, const Hit& hit);

// Whether no ray can ever meet the shape.
inline bool IsNeverHit(const Shape& shape) {
  return shape.PrimitiveCount() == 0 ||
         (shape.surface.alpha.IsConstant() && shape.surface.alpha.constant <= 0);
}

}  // namespace tessera
