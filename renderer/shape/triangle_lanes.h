// Triangles in several lanes: what hits need of them. Every function has the bits of that of PackedTriangle
// or TriangleMesh, lane by lane.
#pragma once

#include "renderer/math/double_lanes.h"
#include "renderer/math/ray_lanes.h"
#include "renderer/shape/hit_lanes.h"
#include "renderer/shape/triangle_mesh.h"

namespace tessera {

struct TriangleCrossings8 {
  Double8 t, u, v;
  LaneSet lanes = 0;  // where there is a crossing
};

struct Triangles8 {
  Vec3x8 p0, p1, p2;

  // As PackedTriangle::Cross.
  TriangleCrossings8 CrossedBy(Vec3x8 origin, Vec3x8 direction) const {
    const Double3x8 d(direction), corner(p0);
    const Double3x8 e1 = Double3x8(p1) - corner, e2 = Double3x8(p2) - corner, s = Double3x8(origin) - corner;
    const Double3x8 p = Cross(d, e2), q = Cross(s, e1);
    const Double8 determinant = Dot(e1, p);
    const Double8 inverse = Double8(1) / determinant;
    return {Dot(e2, q) * inverse, Dot(s, p) * inverse, Dot(d, q) * inverse,
            kAllLanes & ~(determinant == Double8(0)).lanes()};
  }
  Vec3x8 PointAt(Float8 u, Float8 v) const {
    const Double3x8 o(p0);
    const Double3x8 e1 = Double3x8(p1) - o, e2 = Double3x8(p2) - o;
    return (o + e1 * Double8(u) + e2 * Double8(v)).ToFloat();
  }
  Vec3x8 PointErrorAt(Float8 u, Float8 v) const {
    const Vec3x8 sum = Abs(p0 * (Float8(1) - u - v)) + Abs(p1 * u) + Abs(p2 * v);
    const Vec3x8 extent = Max(p0, Max(p1, p2)) - Min(p0, Min(p1, p2));
    return sum * Float8(Gamma(7)) + extent * Float8(Gamma(3));
  }
  // Not defined in the lanes of *extreme, whose areas float cannot hold.
  Vec3x8 WindingNormals(LaneSet* extreme) const {
    const Vec3x8 n = Cross(p0 - p2, p1 - p2);
    const Float8 length_squared = LengthSquared(n);
    constexpr float kSafe = 1e-30f;  // no underflow in the squares
    const Mask8 is_safe =
        (length_squared > Float8(kSafe)) & (length_squared < Float8(std::numeric_limits<float>::infinity()));
    *extreme = kAllLanes & ~is_safe.lanes();
    return n / Sqrt(length_squared);
  }
};

// A triangle in each lane. All lanes are set.
struct TrianglePlaces8 {
  const Point3* points[kLanes];     // of the meshes
  const Normal3* normals[kLanes];   // the same; of meshes without normals anything as long
  const uint32_t* corners[kLanes];  // indices of the vertices
  LaneSet smooth = 0;               // lanes whose meshes have normals
  LaneSet flipped = 0;              // TriangleMesh::flip_normals

  Triangles8 Triangles() const { return {Corners(points, 0), Corners(points, 1), Corners(points, 2)}; }
  // Of lists that have an element for each vertex of the mesh.
  Vec3x8 Corners(const Vec3* const (&lists)[kLanes], int corner) const {
    __m128 rows[kLanes];
#pragma GCC unroll 8
    for (int lane = 0; lane < kLanes; ++lane)
      rows[lane] = Packed3::Load(lists[lane][corners[lane][corner]]).v;
    const Rows8 columns = Transpose(rows);
    return {columns.a, columns.b, columns.c};
  }
};

// What Refine and FillInteraction of TriangleMesh find where `rays` meet the triangles. Returns the lanes for
// which that is defined: not those whose triangles are seen edge on, are met before the ray starts, or have
// areas that float cannot hold.
inline LaneSet FindPoints(const TrianglePlaces8& places, const Rays8& rays, SurfacePoints8* points) {
  const Triangles8 triangles = places.Triangles();
  const TriangleCrossings8 crossings = triangles.CrossedBy(rays.o, rays.d);
  const Double8 exact_u = Clamp(crossings.u, Double8(0), Double8(1));
  const Float8 u = exact_u.ToFloat();
  const Float8 v = Clamp(crossings.v, Double8(0), Double8(1) - exact_u).ToFloat();
  LaneSet extreme = 0;
  const Vec3x8 winding = triangles.WindingNormals(&extreme);
  const LaneSet defined = crossings.lanes & (crossings.t > Double8(0)).lanes() & ~extreme;
  points->p = triangles.PointAt(u, v);
  points->p_error = triangles.PointErrorAt(u, v);
  points->n = NegateWhere(MaskOf(places.flipped), winding);
  points->shading_n = points->n;
  if (places.smooth == 0) return defined;
  const Vec3x8 interpolated = places.Corners(places.normals, 0) * (Float8(1) - u - v) +
                              places.Corners(places.normals, 1) * u + places.Corners(places.normals, 2) * v;
  const Float8 length_squared = LengthSquared(interpolated);
  points->shading_n = Select(MaskOf(places.smooth) & (length_squared > Float8(0)),
                             interpolated / Sqrt(length_squared), points->n);
  points->n = FaceForward(points->n, points->shading_n);
  return defined;
}

}  // namespace tessera
