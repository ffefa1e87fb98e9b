// Spheres, cylinders and disks. The contract of the functions is in form.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "renderer/math/bounds.h"
#include "renderer/math/transform.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/shape_queries.h"

namespace tessera {

// A sphere, cylinder (along z) or disk (at z = z_min) of object space, whole or swept to phi_max. It is its
// only primitive.
struct Quadric {
  static constexpr std::string_view kPrimitives = "quadrics";

  enum class Kind { kSphere, kCylinder, kDisk };
  Kind kind = Kind::kSphere;
  Transform render_from_object;
  float radius = 1, inner_radius = 0;
  float z_min = -1, z_max = 1;
  float phi_max = 2 * kPi;  // radians
  bool flip_normals = false;

  uint32_t PrimitiveCount() const { return 1; }
  uint64_t Bytes() const { return 0; }
  Bounds3 PrimitiveBounds(uint32_t primitive) const;

  bool Intersect(uint32_t primitive, const DoubleRay& ray, double t_max, Crossing* crossing) const;
  int CrossingsMax(uint32_t) const { return kind == Kind::kDisk ? 1 : 2; }
  // Only our own intersection finds quadrics, and that is exact.
  bool Refine(const HitRay&, Hit*) const { return true; }

  void FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const;
  void FillHitPoint(const Hit& hit, const HitRay& ray, HitPoint* point) const;

  // Whole spheres that are not stretched, from outside: uniform over the cone that they fill, the nearer of
  // two points in a direction. Everything else: uniform over the area in object space, with the density that
  // this gives in rendering space.
  std::optional<ShapeSample> Sample(uint32_t primitive, const ReferencePoint& reference, Point2 u,
                                    bool needs_uv) const;
  float Pdf(uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
            const SurfaceInteraction& on_light) const;
  // In rendering space; of stretched spheres and cylinders by quadrature.
  float Area(uint32_t primitive) const;
  NormalCone Normals(uint32_t primitive) const;
};

// Azimuth of an object-space point in [0, 2 pi).
float QuadricPhi(Point3 p);

// A point near the surface, in object space, moved onto it.
Double3 ProjectToQuadric(const Quadric& quadric, Double3 p);

// Parameters of an object-space point on the surface.
Point2 QuadricUv(const Quadric& quadric, Point3 p);
// Unit normal in rendering space at an object-space point, flipped if flip_normals is set.
Normal3 QuadricNormal(const Quadric& quadric, Point3 p);
// Half size of a box, in object space, that holds the true point.
Vec3 QuadricPointError(const Quadric& quadric, Point3 p);

}  // namespace tessera
