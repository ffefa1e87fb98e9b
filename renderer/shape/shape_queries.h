// What a form of shape is asked and what it answers: small values that all forms share.
#pragma once

#include <cstdint>

#include "renderer/math/glossy_lobe.h"
#include "renderer/math/ray.h"
#include "renderer/math/transform.h"
#include "renderer/shape/double3.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// A point where a ray meets a primitive.
struct Crossing {
  double t = 0;        // in units of the ray's direction
  float u = 0, v = 0;  // as Hit::u and Hit::v
};

// The ray of a hit. Taken to the space of the form only by forms that need it there.
struct HitRay {
  const Ray& ray;                                // in rendering space
  const Transform* render_from_group = nullptr;  // null if the shape is not instanced
  bool needs_tangents = true;                    // whether dpdu and dpdv are used, of shading, too
  bool needs_normal_derivatives = true;          // whether dndu and dndv are used

  DoubleRay InShapeSpace() const {
    const DoubleRay exact{Double3(ray.o), Double3(ray.d)};
    return render_from_group == nullptr ? exact : exact.TransformedBy(render_from_group->inverse_matrix());
  }
};

// The part of a surface interaction that an alpha test needs.
struct HitPoint {
  Point3 p;
  Point2 uv;
  Normal3 n;  // geometric, unit
};

// The point to be lit. Its normals are zero if it is not on a surface.
struct ReferencePoint {
  Point3 p;
  Vec3 p_error;
  Normal3 n;  // geometric
  Normal3 shading_n;
  float time = 0;  // seconds
  uint64_t light_links = kAllLightLinks;
  GlossyLobe lobe{};  // of what scatters all its light into one
};

// A point on an emitting primitive.
struct ShapeSample {
  Point3 p;
  Vec3 p_error;
  Normal3 n;  // geometric, unit, as SurfaceInteraction::n would be
  Point2 uv;
  float pdf = 0;  // per solid angle from the reference point
};

// A cone that holds every normal of a primitive, on the side that SurfaceInteraction::n takes.
struct NormalCone {
  Vec3 axis{0, 0, 1};
  float cos_angle = -1;  // -1: all directions
};

}  // namespace tessera
