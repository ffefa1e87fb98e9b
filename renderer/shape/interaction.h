// Hits of rays on surfaces, and the local geometry there.
#pragma once

#include <cstdint>

#include "renderer/math/ray.h"
#include "renderer/math/vec.h"

namespace tessera {

// Rays that do not meet a shape: bits of SurfaceProperties::hidden_from.
enum HiddenFrom : uint8_t {
  kHiddenFromCamera = 1,
  kHiddenFromShadowRays = 2,
  kHiddenFromIndirect = 4,  // from rays that were scattered before
};

// Which lights illuminate a point: bit i is set if those of link i do (LightLinks).
constexpr uint64_t kAllLightLinks = ~uint64_t{0};

// What an accelerator finds: a primitive and a place on it.
struct Hit {
  static constexpr uint32_t kNoInstance = 0xffffffffu;
  float t = 0;  // in units of the ray's direction
  // Triangle: barycentrics of vertices 1 and 2; patch: its (u, v); curve: u along the segment, v across;
  // quadric: unused.
  float u = 0, v = 0;
  uint32_t shape = 0;      // index in Geometry::shapes, or in the group's shapes when instanced
  uint32_t primitive = 0;  // triangle, patch or curve piece of the shape; 0 for quadrics
  uint32_t instance = kNoInstance;
};

// The local geometry of a surface, in rendering space.
struct SurfaceInteraction {
  Point3 p;
  Vec3 p_error;  // half size of a box around p that holds the true point
  Normal3 n;     // geometric, unit; on the side given by the shape's orientation and reversal
  Point2 uv;
  Vec3 dpdu, dpdv;    // may be 0 unless SurfaceProperties::needs_tangents
  struct Shading {    // as interpolated from vertex normals and tangents
    Normal3 n;        // unit, in the hemisphere of n
    Vec3 dpdu, dpdv;  // the same
    Vec3 dndu, dndv;  // 0 unless SurfaceProperties::needs_normal_derivatives
  } shading;
  Vec3 wo;  // unit, against the ray
  float time = 0;
  int material = 0;                             // index into the scene's materials
  int area_light = -1;                          // index into the scene's lights, or -1
  int inside_medium = -1, outside_medium = -1;  // -1: vacuum
  uint8_t hidden_from = 0;                      // HiddenFrom
  // Of curves: the surface depends on the ray, and p_error is its width.
  bool faces_rays = false;
  uint64_t light_links = kAllLightLinks;

  // A ray that leaves this point along d without hitting the surface here again.
  Ray SpawnRay(Vec3 d) const { return {OffsetRayOrigin(p, p_error, n, d), d, INFINITY, time}; }
  // The same in the place of another, member by member: the copy of a ray waits for the stores of its parts.
  void SpawnRay(Vec3 d, Ray* ray) const {
    ray->o = OffsetRayOrigin(p, p_error, n, d);
    ray->d = d;
    ray->t_max = INFINITY;
    ray->time = time;
  }
};

// Shadow rays end short of their targets by this part of their length.
constexpr float kShadowEpsilon = 0.0001f;

// A ray of length just under 1 from one surface point to another, for shadow tests.
inline Ray SpawnRayTo(const Point3& from, const Vec3& from_error, const Normal3& from_n, const Point3& to,
                      const Vec3& to_error, const Normal3& to_n, float time) {
  const Packed3 start = Packed3::Load(from), end = Packed3::Load(to);
  const Packed3 a = OffsetRayOrigin(start, Packed3::Load(from_error), Packed3::Load(from_n), end - start);
  const Packed3 b = OffsetRayOrigin(end, Packed3::Load(to_error), Packed3::Load(to_n), a - end);
  return {a.Unpack(), (b - a).Unpack(), 1 - kShadowEpsilon, time};
}

}  // namespace tessera
