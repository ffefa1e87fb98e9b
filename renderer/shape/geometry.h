// Everything that can be hit, in rendering space: shapes with their surface properties, groups that are
// instanced, instances. Immutable once built.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/math/transform.h"
#include "renderer/math/vec.h"
#include "renderer/texture/texture.h"

namespace tessera {

// What all primitives of one shape have in common.
struct SurfaceProperties {
  int material = 0;
  // Light of primitive 0; primitive i is light area_light + i. -1: no emitter.
  int area_light = -1;
  int inside_medium = -1, outside_medium = -1;
  bool is_interface = false;  // no surface, only a change of medium: rays pass
  // Opacity. Below 1 a ray passes with probability 1 - alpha, decided by a hash of its origin and direction.
  FloatInput alpha{1.0f, -1};
  bool HasAlpha() const { return !alpha.IsConstant() || alpha.constant < 1; }
};

// Vertices are in rendering space (of a group: in the group's space). Lists other than P may be empty. A P
// whose capacity exceeds its size is shared with Embree, which reads 16 bytes at each vertex; any other is
// copied.
struct TriangleMesh {
  std::vector<Point3> P;
  std::vector<Normal3> N;
  std::vector<Vec3> S;  // tangents
  std::vector<Point2> uv;
  std::vector<uint32_t> indices;  // three per triangle
  bool flip_normals = false;      // reversed orientation exclusive-or a transform that swaps handedness
};

// Patches of four vertices in the order (0,0) (1,0) (0,1) (1,1).
struct BilinearMesh {
  std::vector<Point3> P;
  std::vector<Normal3> N;
  std::vector<Point2> uv;
  std::vector<uint32_t> indices;  // four per patch
  bool flip_normals = false;
};

// A sphere, cylinder (along z) or disk (at z = z_min) of object space, whole or swept to phi_max.
struct Quadric {
  enum class Kind { kSphere, kCylinder, kDisk };
  Kind kind = Kind::kSphere;
  Transform render_from_object;
  float radius = 1, inner_radius = 0;
  float z_min = -1, z_max = 1;
  float phi_max = 2 * kPi;  // radians
  bool flip_normals = false;
};

struct Shape {
  SurfaceProperties surface;
  std::variant<TriangleMesh, BilinearMesh, Quadric> form;
  // Its directive in SceneDescription::shapes (of a group: in ObjectDescription::shapes). A directive may
  // yield two shapes, as a PLY file of triangles and quads does. The caller of BuildShape fills it.
  int description = 0;

  uint32_t PrimitiveCount() const;
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
  uint64_t PrimitiveCount() const;  // stored ones: a group counts once
};

// The shape that a hit names, in its own group if instanced.
const Shape& ShapeOf(const Geometry& geometry, uint32_t instance, uint32_t shape);

}  // namespace tessera
