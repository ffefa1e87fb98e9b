#include "renderer/shape/quadric.h"

#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

// The polar angles at which a sphere is cut off, as pbrt names them: at z_min and z_max.
struct SphereAngles {
  float theta_z_min, theta_z_max;

  explicit SphereAngles(const Quadric& sphere)
      : theta_z_min(Angle(sphere, sphere.z_min)), theta_z_max(Angle(sphere, sphere.z_max)) {}
  float Range() const { return theta_z_max - theta_z_min; }

 private:
  static float Angle(const Quadric& sphere, float z) {
    if (z <= -sphere.radius) return kPi;
    if (z >= sphere.radius) return 0;
    return std::acos(z / sphere.radius);
  }
};

// At the poles the azimuth is undefined: moves such a point a little to the side.
Point3 AvoidPole(const Quadric& sphere, Point3 p) {
  if (p.x == 0 && p.y == 0) p.x = 1e-5f * sphere.radius;
  return p;
}

struct LocalDerivatives {
  Vec3 dpdu, dpdv;
  NormalDerivatives dn;
};

LocalDerivatives DifferentiateSphere(const Quadric& sphere, Point3 p, bool needs_normal_derivatives) {
  p = AvoidPole(sphere, p);
  const float range = SphereAngles(sphere).Range();
  const float phi_max = sphere.phi_max;
  const float z_radius = std::sqrt(p.x * p.x + p.y * p.y);
  const float cos_phi = p.x / z_radius;
  const float sin_phi = p.y / z_radius;
  LocalDerivatives d;
  d.dpdu = {-phi_max * p.y, phi_max * p.x, 0};
  d.dpdv = Vec3{p.z * cos_phi, p.z * sin_phi, -z_radius} * range;
  if (!needs_normal_derivatives) return d;
  d.dn = DifferentiateNormal(d.dpdu, d.dpdv, Vec3{p.x, p.y, 0} * (-phi_max * phi_max),
                             Vec3{-sin_phi, cos_phi, 0} * (range * p.z * phi_max), p * (-range * range));
  return d;
}

LocalDerivatives DifferentiateCylinder(const Quadric& cylinder, Point3 p) {
  const float phi_max = cylinder.phi_max;
  LocalDerivatives d;
  d.dpdu = {-phi_max * p.y, phi_max * p.x, 0};
  d.dpdv = {0, 0, cylinder.z_max - cylinder.z_min};
  d.dn = DifferentiateNormal(d.dpdu, d.dpdv, Vec3{p.x, p.y, 0} * (-phi_max * phi_max), {}, {});
  return d;
}

LocalDerivatives DifferentiateDisk(const Quadric& disk, Point3 p) {
  const float r = std::sqrt(p.x * p.x + p.y * p.y);
  LocalDerivatives d;
  if (r == 0) {  // the centre: any direction is right
    d.dpdu = {0, disk.phi_max * disk.radius, 0};
    d.dpdv = {disk.inner_radius - disk.radius, 0, 0};
    return d;
  }
  d.dpdu = {-disk.phi_max * p.y, disk.phi_max * p.x, 0};
  d.dpdv = Vec3{p.x, p.y, 0} * ((disk.inner_radius - disk.radius) / r);
  return d;
}

// Outward (of a disk: +z), not unit, not flipped.
Vec3 ObjectNormal(const Quadric& quadric, Point3 p) {
  switch (quadric.kind) {
    case Quadric::Kind::kSphere: return p;
    case Quadric::Kind::kCylinder: return {p.x, p.y, 0};
    case Quadric::Kind::kDisk: break;
  }
  return {0, 0, 1};
}

// Where a hit is in object space, except for the rounding of its distance.
Double3 ObjectPoint(const Quadric& quadric, const Hit& hit, const HitRay& ray) {
  return TransformPoint(quadric.render_from_object.inverse_matrix(), ray.InShapeSpace().At(hit.t));
}

LocalDerivatives Differentiate(const Quadric& quadric, Point3 p, bool needs_normal_derivatives) {
  switch (quadric.kind) {
    case Quadric::Kind::kSphere: return DifferentiateSphere(quadric, p, needs_normal_derivatives);
    case Quadric::Kind::kCylinder: return DifferentiateCylinder(quadric, p);
    case Quadric::Kind::kDisk: return DifferentiateDisk(quadric, p);
  }
  return {};
}

}  // namespace

Bounds3 Quadric::PrimitiveBounds(uint32_t) const {
  const float r = radius;
  const bool flat = kind == Kind::kDisk;
  const Bounds3 object{{-r, -r, z_min}, {r, r, flat ? z_min : z_max}};
  Bounds3 bounds = render_from_object.ToBounds(object);
  // Room for the rounding of the corners.
  const Vec3 largest = Max(Abs(bounds.min), Abs(bounds.max));
  bounds.min = bounds.min - largest * Gamma(8);
  bounds.max = bounds.max + largest * Gamma(8);
  return bounds;
}

float QuadricPhi(Point3 p) {
  const float phi = std::atan2(p.y, p.x);
  return phi < 0 ? phi + 2 * kPi : phi;
}

Double3 ProjectToQuadric(const Quadric& quadric, Double3 p) {
  const double r = quadric.radius;
  switch (quadric.kind) {
    case Quadric::Kind::kSphere: {
      const double length = std::sqrt(Dot(p, p));
      return length > 0 ? p * (r / length) : Double3(0, 0, r);
    }
    case Quadric::Kind::kCylinder: {
      const double length = std::sqrt(p.x * p.x + p.y * p.y);
      return length > 0 ? Double3(p.x * (r / length), p.y * (r / length), p.z) : Double3(r, 0, p.z);
    }
    case Quadric::Kind::kDisk: break;
  }
  return {p.x, p.y, quadric.z_min};
}

Point2 QuadricUv(const Quadric& quadric, Point3 p) {
  if (quadric.kind == Quadric::Kind::kSphere) p = AvoidPole(quadric, p);
  const float u = quadric.phi_max > 0 ? QuadricPhi(p) / quadric.phi_max : 0;
  switch (quadric.kind) {
    case Quadric::Kind::kSphere: {
      const SphereAngles angles(quadric);
      const float theta = std::acos(std::clamp(p.z / quadric.radius, -1.0f, 1.0f));
      return {u, (theta - angles.theta_z_min) / angles.Range()};
    }
    case Quadric::Kind::kCylinder: return {u, (p.z - quadric.z_min) / (quadric.z_max - quadric.z_min)};
    case Quadric::Kind::kDisk: break;
  }
  const float r = std::sqrt(p.x * p.x + p.y * p.y);
  return {u, (quadric.radius - r) / (quadric.radius - quadric.inner_radius)};
}

Normal3 QuadricNormal(const Quadric& quadric, Point3 p) {
  const Normal3 n = Normalize(quadric.render_from_object.ToNormal(ObjectNormal(quadric, p)));
  return quadric.flip_normals ? -n : n;
}

Vec3 QuadricPointError(const Quadric& quadric, Point3 p) {
  switch (quadric.kind) {
    case Quadric::Kind::kSphere: return Abs(p) * Gamma(5);
    case Quadric::Kind::kCylinder: return Abs(Vec3{p.x, p.y, 0}) * Gamma(3);
    case Quadric::Kind::kDisk: break;
  }
  return {};
}

void Quadric::FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const {
  const Double3 exact = ProjectToQuadric(*this, ObjectPoint(*this, hit, ray));
  const Point3 p = exact.ToFloat();
  const LocalDerivatives d = Differentiate(*this, p, ray.needs_normal_derivatives);
  const PointWithError point =
      TransformPointWithError(render_from_object, exact, QuadricPointError(*this, p));
  interaction->p = point.p;
  interaction->p_error = point.error;
  interaction->uv = QuadricUv(*this, p);
  interaction->dpdu = render_from_object.ToVector(d.dpdu);
  interaction->dpdv = render_from_object.ToVector(d.dpdv);
  interaction->n = QuadricNormal(*this, p);
  interaction->shading = {interaction->n, interaction->dpdu, interaction->dpdv,
                          render_from_object.ToNormal(d.dn.dndu), render_from_object.ToNormal(d.dn.dndv)};
}

void Quadric::FillHitPoint(const Hit& hit, const HitRay& ray, HitPoint* point) const {
  const Point3 p = ProjectToQuadric(*this, ObjectPoint(*this, hit, ray)).ToFloat();
  point->uv = QuadricUv(*this, p);
  point->n = QuadricNormal(*this, p);
}

}  // namespace tessera
