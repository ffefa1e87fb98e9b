// Triangles that share vertices. The contract of the functions is in form.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/shape_queries.h"
#include "renderer/shape/triangle.h"

namespace tessera {

// Lists other than P may be empty. A P whose capacity exceeds its size is shared with Embree, which reads 16
// bytes at each vertex; any other is copied.
struct TriangleMesh {
  static constexpr std::string_view kPrimitives = "triangles";

  std::vector<Point3> P;
  std::vector<Normal3> N;
  std::vector<Vec3> S;  // tangents
  std::vector<Point2> uv;
  std::vector<uint32_t> indices;  // three per triangle
  bool flip_normals = false;      // reversed orientation exclusive-or a transform that swaps handedness

  uint32_t PrimitiveCount() const { return static_cast<uint32_t>(indices.size() / 3); }
  uint64_t Bytes() const;
  TrianglePoints At(uint32_t primitive) const {
    const uint32_t* v = &indices[3 * size_t{primitive}];
    return {P[v[0]], P[v[1]], P[v[2]]};
  }
  Bounds3 PrimitiveBounds(uint32_t primitive) const {
    Bounds3 bounds;
    const auto [p0, p1, p2] = At(primitive);
    for (const Point3 p : {p0, p1, p2}) bounds.Add(p);
    return bounds;
  }

  bool Intersect(uint32_t primitive, const DoubleRay& ray, double t_max, Crossing* crossing) const;
  int CrossingsMax(uint32_t) const { return 1; }
  bool Refine(const HitRay& ray, Hit* hit) const;

  void FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const;
  void FillHitPoint(const Hit& hit, const HitRay& ray, HitPoint* point) const;

  // By solid angle, weighted by the cosine at the reference point's surface; by area where the triangle
  // covers too little or too much of the sphere for that to be accurate (Pharr, Jakob, Humphreys 2023,
  // section 6.5.4).
  std::optional<ShapeSample> Sample(uint32_t primitive, const ReferencePoint& reference, Point2 u,
                                    bool needs_uv) const;
  float Pdf(uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
            const SurfaceInteraction& on_light) const;
  float Area(uint32_t primitive) const { return TriangleArea(At(primitive)); }
  NormalCone Normals(uint32_t primitive) const;

  // The geometric normal at barycentrics (u, v): on the side of the interpolated normal if the mesh has
  // normals, else as flip_normals says. `triangle` is At(primitive).
  Normal3 Normal(uint32_t primitive, const TrianglePoints& triangle, float u, float v) const;
  Point2 TextureCoordinates(uint32_t primitive, float u, float v) const;
};

}  // namespace tessera
