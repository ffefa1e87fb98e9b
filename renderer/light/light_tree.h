// A tree over the lights that have a position, to choose one with a probability near its share of the light
// that arrives at a point. The four children of a node are weighted in one SIMD computation. Immutable and
// deterministic; a choice allocates nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/light/light_bounds.h"
#include "renderer/light/light_choice.h"
#include "renderer/math/float4.h"
#include "renderer/shape/shape_queries.h"

namespace tessera {

// The bounds of four children, each element its own. Unused children have strength 0.
struct alignas(16) LightTreeNode {
  static constexpr uint32_t kLeaf = 0x80000000u;  // flag of a child that is a light

  Float4 center_x, center_y, center_z, radius_squared;
  Float4 axis_x, axis_y, axis_z;
  Float4 cos_theta_o, sin_theta_o, cos_theta_e;
  Float4 strength, plane_min;
  Float4 two_sided;  // all bits set or none
  uint32_t child[4] = {};

  void SetChild(int slot, const LightBounds& bounds, uint32_t value);
  // Upper estimates of what the reference point receives from each child: the irradiance at its shading
  // normal, or what its lobe scatters, in the same unit.
  Float4 Importance(const ReferencePoint& reference) const;
  // Estimates of what a medium along a ray scatters of each child, if all lights emitted evenly to all sides
  // and nothing were absorbed: the integral over the ray of strength over squared distance.
  Float4 ImportanceAlong(const Ray& ray) const;
};

class LightTree {
 public:
  LightTree() = default;
  // One entry of `bounds` for each of `lights`, which are indices below light_count. Omits lights of strength
  // 0.
  LightTree(std::span<const LightBounds> bounds, std::span<const uint32_t> lights, size_t light_count);

  bool empty() const { return nodes_.empty(); }
  bool Contains(int light) const { return !places_.empty() && places_[light] != kNowhere; }
  // An upper estimate of what arrives from all lights.
  float Importance(const ReferencePoint& reference) const {
    return empty() ? 0 : Sum(nodes_[0].Importance(reference));
  }
  // Returns nullopt if nothing arrives. u in [0, 1).
  std::optional<ChosenLight> Choose(const ReferencePoint& reference, float u) const;
  // The probability with which Choose takes `light`, which the tree contains.
  float Pmf(const ReferencePoint& reference, int light) const;
  // The same for the medium along a ray.
  float ImportanceAlong(const Ray& ray) const { return empty() ? 0 : Sum(nodes_[0].ImportanceAlong(ray)); }
  std::optional<ChosenLight> ChooseAlong(const Ray& ray, float u) const;
  float PmfAlong(const Ray& ray, int light) const;
  // Around `light`, which the tree contains.
  BoundingSphere SphereOf(int light) const;
  size_t bytes() const { return nodes_.size() * sizeof(LightTreeNode) + places_.size() * sizeof(uint32_t); }

 private:
  static constexpr uint32_t kNowhere = 0xffffffffu;

  // The importance of the children of a node: Float4 (const LightTreeNode&).
  template <typename ImportanceOf>
  std::optional<ChosenLight> ChooseBy(const ImportanceOf& importance, float u) const;
  template <typename ImportanceOf>
  float PmfBy(const ImportanceOf& importance, int light) const;

  std::vector<LightTreeNode> nodes_;  // the first is the root
  std::vector<uint32_t> parents_;     // of each node: 4 * parent + slot
  std::vector<uint32_t> places_;      // of each light: 4 * node + slot
};

}  // namespace tessera
