// Everything that can be hit, in rendering space: shapes with their surface properties, groups of shapes that
// are instanced, and the instances. Immutable once built.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/math/flat_transform.h"
#include "renderer/math/moving_transform.h"
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
  int name = 0;  // in mattes: an index that its user knows
  // Only a change of medium, no surface: rays pass.
  bool is_interface = false;
  uint8_t hidden_from = 0;  // HiddenFrom
  // Whether the material uses dpdu and dpdv of SurfaceInteraction and its shading. They may be missing
  // otherwise.
  bool needs_tangents = true;
  // Whether it uses SurfaceInteraction::Shading::dndu and dndv, too. They are not computed otherwise.
  bool needs_normal_derivatives = true;
  uint64_t light_links = kAllLightLinks;
  // Opacity. Below 1 a ray passes with probability 1 - alpha, decided by a hash of its origin and direction.
  FloatInput alpha{1.0f, -1};
  bool operator==(const SurfaceProperties&) const = default;
  bool HasAlpha() const { return !alpha.IsConstant() || alpha.constant < 1; }
  // Whether Accelerator::Occluded heeds it.
  bool StopsShadowRays() const { return !is_interface && (hidden_from & kHiddenFromShadowRays) == 0; }
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
  Transform render_from_group;  // unused if it moves
  int motion = -1;              // index into Geometry::motions; -1: it stands still
};

// Seconds.
struct TimeRange {
  float start = 0, end = 0;
};

struct Geometry {
  std::vector<Shape> shapes;
  std::vector<ShapeGroup> groups;
  std::vector<Instance> instances;
  std::vector<MovingTransform> motions{};
  TimeRange times{};  // of all rays

  // Of an instance of a group with these bounds, at all times.
  Bounds3 InstanceBounds(const Instance& instance, const Bounds3& group) const;
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

inline Shape& ShapeOf(Geometry& geometry, uint32_t instance, uint32_t shape) {
  return const_cast<Shape&>(ShapeOf(std::as_const(geometry), instance, shape));
}

// Where an instance is at the time of a ray.
class InstancePlace {
 public:
  InstancePlace(const Geometry& geometry, uint32_t instance, float time_s) {
    if (instance == Hit::kNoInstance) return;
    const Instance& placed = geometry.instances[instance];
    render_from_group_ = &placed.render_from_group;
    if (placed.motion < 0) return;
    moved_ = geometry.motions[static_cast<size_t>(placed.motion)].At(time_s);
    render_from_group_ = &*moved_;
  }
  InstancePlace(const InstancePlace&) = delete;
  InstancePlace& operator=(const InstancePlace&) = delete;

  // Null without an instance.
  const Transform* render_from_group() const { return render_from_group_; }
  // Whether it has no volume at the time, and no ray meets it.
  bool is_flat() const { return moved_ && IsFlat(*moved_); }

 private:
  const Transform* render_from_group_ = nullptr;
  std::optional<Transform> moved_;
};

}  // namespace tessera
