#include <algorithm>

#include "renderer/shape/shape_directive.h"

namespace tessera {
namespace {

float PhiMax(ParameterReader& reader) {
  const float degrees = std::clamp(reader.Float("phimax", 360), 0.0f, 360.0f);
  return degrees == 360 ? 2 * kPi : Radians(degrees);
}

Quadric ReadQuadric(const ShapeDirective& directive, Quadric::Kind kind) {
  ParameterReader& reader = directive.reader;
  const Transform& render_from_object = directive.placement.render_from_object;
  Quadric quadric;
  quadric.kind = kind;
  quadric.render_from_object = render_from_object;
  quadric.flip_normals = directive.placement.FlipsNormals();
  quadric.radius = reader.Float("radius", 1);
  if (!(quadric.radius > 0)) reader.FailAt("radius", "radius must be above 0");
  if (kind == Quadric::Kind::kDisk) {
    quadric.z_min = quadric.z_max = reader.Float("height", 0);
    quadric.inner_radius = reader.Float("innerradius", 0);
  } else {
    const bool is_sphere = kind == Quadric::Kind::kSphere;
    const float z0 = reader.Float("zmin", is_sphere ? -quadric.radius : -1);
    const float z1 = reader.Float("zmax", is_sphere ? quadric.radius : 1);
    quadric.z_min = std::min(z0, z1);
    quadric.z_max = std::max(z0, z1);
    if (is_sphere && quadric.radius > 0) {
      quadric.z_min = std::clamp(quadric.z_min, -quadric.radius, quadric.radius);
      quadric.z_max = std::clamp(quadric.z_max, -quadric.radius, quadric.radius);
    }
  }
  quadric.phi_max = PhiMax(reader);
  return quadric;
}

}  // namespace

std::vector<Form> ReadSphere(const ShapeDirective& directive) {
  return {ReadQuadric(directive, Quadric::Kind::kSphere)};
}

std::vector<Form> ReadCylinder(const ShapeDirective& directive) {
  return {ReadQuadric(directive, Quadric::Kind::kCylinder)};
}

std::vector<Form> ReadDisk(const ShapeDirective& directive) {
  return {ReadQuadric(directive, Quadric::Kind::kDisk)};
}

}  // namespace tessera
