// Points on emitting shapes, sampled as seen from a reference point. Emitters are never instanced.
#pragma once

#include <optional>

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

struct ShapeSample {
  Point3 p;
  Vec3 p_error;
  Normal3 n;  // geometric, unit, as SurfaceInteraction::n would be
  Point2 uv;
  float pdf = 0;  // per solid angle from the reference point
};

// The point that is lit; n is zero if it is not on a surface.
struct ReferencePoint {
  Point3 p;
  Vec3 p_error;
  Normal3 n;  // geometric
  Normal3 shading_n;
};

// A point on primitive `primitive` of `shape`, u in [0,1)^2. Nothing if the primitive cannot be seen or has
// no area.
std::optional<ShapeSample> SampleShape(const Shape& shape, uint32_t primitive,
                                       const ReferencePoint& reference, Point2 u);

// The density per solid angle with which SampleShape would have found the point `on_light`, seen along unit
// `wi`.
float ShapePdf(const Shape& shape, uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
               const SurfaceInteraction& on_light);

// Whether SampleShape, of two points of a primitive in one direction, only ever gives the nearer one.
bool SamplesNearestOnly(const Shape& shape, const ReferencePoint& reference);

float ShapeArea(const Shape& shape, uint32_t primitive);
Bounds3 ShapeBounds(const Shape& shape, uint32_t primitive);

// A cone that holds every normal of the primitive, on the side that SurfaceInteraction::n takes.
struct NormalCone {
  Vec3 axis{0, 0, 1};
  float cos_angle = -1;  // -1: all directions
};
NormalCone ShapeNormals(const Shape& shape, uint32_t primitive);

}  // namespace tessera
