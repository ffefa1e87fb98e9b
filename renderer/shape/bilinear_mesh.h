// Bilinear patches that share vertices. The contract of the functions is in form.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/patch.h"
#include "renderer/shape/shape_queries.h"

namespace tessera {

// Patches of four vertices in the order (0,0) (1,0) (0,1) (1,1). Lists other than P may be empty; P as that
// of TriangleMesh.
struct BilinearMesh {
  static constexpr std::string_view kPrimitives = "patches";

  std::vector<Point3> P;
  std::vector<Normal3> N;
  std::vector<Point2> uv;
  std::vector<uint32_t> indices;  // four per patch
  bool flip_normals = false;

  uint32_t PrimitiveCount() const { return static_cast<uint32_t>(indices.size() / 4); }
  uint64_t Bytes() const;
  PatchPoints At(uint32_t primitive) const {
    const uint32_t* v = &indices[4 * size_t{primitive}];
    return {P[v[0]], P[v[1]], P[v[2]], P[v[3]]};
  }
  Bounds3 PrimitiveBounds(uint32_t primitive) const {
    Bounds3 bounds;
    const auto [p00, p10, p01, p11] = At(primitive);
    for (const Point3 p : {p00, p10, p01, p11}) bounds.Add(p);
    return bounds;
  }

  bool Intersect(uint32_t primitive, const DoubleRay& ray, double t_max, Crossing* crossing) const;
  int CrossingsMax(uint32_t primitive) const { return IsRectangle(At(primitive)) ? 1 : 2; }
  bool Refine(const HitRay& ray, Hit* hit) const;

  void FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const;
  void FillHitPoint(const Hit& hit, const HitRay& ray, HitPoint* point) const;

  // Rectangles by solid angle, weighted by the cosine at the reference point's surface; other patches, and
  // rectangles that cover too little of the sphere, by area.
  std::optional<ShapeSample> Sample(uint32_t primitive, const ReferencePoint& reference, Point2 u,
                                    bool needs_uv) const;
  float Pdf(uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
            const SurfaceInteraction& on_light) const;
  float Area(uint32_t primitive) const { return PatchArea(At(primitive)); }
  NormalCone Normals(uint32_t primitive) const;

  // The geometric normal at patch parameters uv: on the side of the interpolated normal if the mesh has
  // normals, else as flip_normals says. `patch` is At(primitive).
  Normal3 Normal(uint32_t primitive, const PatchPoints& patch, Point2 uv) const;
  // From patch parameters to texture coordinates: the mesh's, or the parameters themselves.
  Point2 TextureCoordinates(uint32_t primitive, Point2 uv) const;
};

}  // namespace tessera
