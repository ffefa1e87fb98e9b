// Points on emitting shapes, sampled as seen from a reference point. Emitters are never instanced.
#pragma once

#include <optional>

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// A point on primitive `primitive` of `shape`, u in [0,1)^2. Returns nullopt if the primitive cannot be seen
// or has no area. needs_uv: whether the sample must have its texture coordinates.
std::optional<ShapeSample> SampleShape(const Shape& shape, uint32_t primitive,
                                       const ReferencePoint& reference, Point2 u, bool needs_uv = true);

// The density per solid angle with which SampleShape would have found the point `on_light`, seen along unit
// `wi`: 0 for points that it never returns, such as those on the far side of a sphere.
float ShapePdf(const Shape& shape, uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
               const SurfaceInteraction& on_light);

float ShapeArea(const Shape& shape, uint32_t primitive);
Bounds3 ShapeBounds(const Shape& shape, uint32_t primitive);
NormalCone ShapeNormals(const Shape& shape, uint32_t primitive);

}  // namespace tessera
