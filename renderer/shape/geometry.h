// Everything that can be hit, in rendering space: shapes with their surface properties, groups of shapes that
// are instanced, and the instances. Immutable once built.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/math/transform.h"
#include "renderer/shape/form.h"
#include "renderer/texture/texture.h"
#include "renderer/util/dispatch.h"

namespace tessera {

// What all primitives of one shape have in common.
struct SurfaceProperties {
  int material = 0;
  // Light of primitive 0; primitive i is light area_light + i. -1: no emitter.
  int area_light = -1;
  int inside_medium = -1, outside_medium = -1;
  // Only a change of medium, no surface: rays pass.
  bool is_interface = false;
  // Opacity. Below 1 a ray passes with probability 1 - alpha, decided by a hash of its origin and direction.
  FloatInput alpha{1.0f, -1};
  bool operator==(const SurfaceProperties&) const = default;
  bool HasAlpha() const { return !alpha.IsConstant() || alpha.constant < 1; }
};

struct Shape {
  SurfaceProperties surface;
  Form form;

  uint32_t PrimitiveCount() const;
  uint64_t Bytes() const;  // in addition to the struct itself
  Bounds3 Bounds() const;
};

// Shapes of an object definition, in its own space.
struct ShapeGroup {
  std::vector<Shape> shapes;
};

struct Instance {
  int group = 0;
  Transform render_from_group;
};

struct Geometry {
  std::vector<Shape> shapes;
  std::vector<ShapeGroup> groups;
  std::vector<Instance> instances;

  // Of everything, instances included.
  Bounds3 Bounds() const;
  // Those that are stored: the primitives of a group count once.
  uint64_t PrimitiveCount() const;
};

// The shape that a hit names: one of the instance's group if the hit has an instance.
inline const Shape& ShapeOf(const Geometry& geometry, uint32_t instance, uint32_t shape) {
  if (instance == Hit::kNoInstance) return geometry.shapes[shape];
  return geometry.groups[geometry.instances[instance].group].shapes[shape];
}
// `ray` (rendering space) as the shapes of the instance's group see it.
inline HitRay RayOf(const Geometry& geometry, uint32_t instance, const Ray& ray) {
  if (instance == Hit::kNoInstance) return {ray};
  return {ray, &geometry.instances[instance].render_from_group};
}

}  // namespace tessera
