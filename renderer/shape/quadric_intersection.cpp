#include <cmath>

#include "renderer/shape/quadric.h"

namespace tessera {
namespace {

// Whether a point of the full surface, in object space, is in the part that exists.
bool IsPartOf(const Quadric& quadric, Double3 p) {
  if (quadric.kind == Quadric::Kind::kCylinder && (p.z < quadric.z_min || p.z > quadric.z_max)) return false;
  if (quadric.kind == Quadric::Kind::kSphere) {
    if (quadric.z_min > -quadric.radius && p.z < quadric.z_min) return false;
    if (quadric.z_max < quadric.radius && p.z > quadric.z_max) return false;
  }
  return quadric.phi_max >= 2 * kPi || QuadricPhi(p.ToFloat()) <= quadric.phi_max;
}

// Both roots of the distance to the centre (axis) being the radius, in ascending order. The discriminant is
// computed from the point of closest approach, which keeps its precision for far spheres.
bool SolveRound(const Quadric& quadric, const DoubleRay& ray, double roots[2]) {
  Double3 o = ray.o, d = ray.d;
  if (quadric.kind == Quadric::Kind::kCylinder) o.z = d.z = 0;
  const double d_squared = Dot(d, d);
  if (!(d_squared > 0)) return false;
  const double middle = -Dot(o, d) / d_squared;
  const Double3 closest = o + d * middle;
  const double distance = std::sqrt(Dot(closest, closest));
  const double discriminant = (quadric.radius - distance) * (quadric.radius + distance);
  if (!(discriminant >= 0)) return false;
  const double half_chord = std::sqrt(discriminant / d_squared);
  roots[0] = middle - half_chord;
  roots[1] = middle + half_chord;
  return true;
}

bool IntersectDisk(const Quadric& disk, const DoubleRay& ray, double t_max, Crossing* crossing) {
  if (ray.d.z == 0) return false;
  const double t_plane = (disk.z_min - ray.o.z) / ray.d.z;
  if (!(t_plane > 0 && t_plane <= t_max)) return false;
  const Double3 p = ray.At(t_plane);
  const double r_squared = p.x * p.x + p.y * p.y;
  const double radius = disk.radius, inner_radius = disk.inner_radius;
  if (r_squared > radius * radius || r_squared < inner_radius * inner_radius) return false;
  if (!IsPartOf(disk, p)) return false;
  *crossing = {.t = t_plane};
  return true;
}

}  // namespace

bool Quadric::Intersect(uint32_t, const DoubleRay& shape_ray, double t_max, Crossing* crossing) const {
  const DoubleRay ray = shape_ray.TransformedBy(render_from_object.inverse_matrix());
  if (kind == Kind::kDisk) return IntersectDisk(*this, ray, t_max, crossing);
  double roots[2];
  if (!SolveRound(*this, ray, roots)) return false;
  for (const double root : roots) {
    if (!(root > 0 && root <= t_max)) continue;
    if (!IsPartOf(*this, ProjectToQuadric(*this, ray.At(root)))) continue;
    *crossing = {.t = root};
    return true;
  }
  return false;
}

}  // namespace tessera
