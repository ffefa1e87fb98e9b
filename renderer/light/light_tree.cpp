#include "renderer/light/light_tree.h"

#include <bit>

#include "renderer/light/light_tree_builder.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

Float4 Select(__m128 mask, Float4 yes, Float4 no) {
  return _mm_blendv_ps(no.v, yes.v, mask);
}
__m128 Greater(Float4 a, Float4 b) {
  return _mm_cmpgt_ps(a.v, b.v);
}

// cos(max(0, a - b)) for angles in [0, pi] given by cosine and sine.
Float4 CosClampedDifference(Float4 cos_a, Float4 sin_a, Float4 cos_b, Float4 sin_b) {
  return Select(Greater(cos_a, cos_b), Float4(1.0f), cos_a * cos_b + sin_a * sin_b);
}
Float4 SinClampedDifference(Float4 cos_a, Float4 sin_a, Float4 cos_b, Float4 sin_b) {
  return Select(Greater(cos_a, cos_b), Float4(0.0f), sin_a * cos_b - cos_a * sin_b);
}
Float4 SinOf(Float4 cosine) {
  return SafeSqrt(Float4(1.0f) - cosine * cosine);
}

// A lobe with a density above this over the solid angle of a child mostly finds it without light sampling.
constexpr float kFoundByLobe = 4;

// The density of a lobe at an angle to its axis, relative to that of a diffuse surface at its normal: about
// that of half vectors (Walter et al. 2007) at half the angle. Limited where scattered rays find the child,
// whose bounding sphere subtends sin2_size.
Float4 LobeWeight(float alpha_squared, Float4 cosine, Float4 sin2_size) {
  const Float4 facing = alpha_squared * (cosine + 1);
  const Float4 falloff = SafeDiv(facing, facing + (1 - cosine));  // 1 / (1 + tan^2 / alpha^2)
  const Float4 density = falloff * falloff * (0.25f / alpha_squared);
  return Min(density, kFoundByLobe / sin2_size);
}

}  // namespace

void LightTreeNode::SetChild(int slot, const LightBounds& bounds, uint32_t value) {
  const Point3 center = bounds.box.Center();
  center_x.Set(slot, center.x);
  center_y.Set(slot, center.y);
  center_z.Set(slot, center.z);
  radius_squared.Set(slot, LengthSquared(bounds.box.Diagonal()) / 4);
  axis_x.Set(slot, bounds.axis.x);
  axis_y.Set(slot, bounds.axis.y);
  axis_z.Set(slot, bounds.axis.z);
  cos_theta_o.Set(slot, bounds.cos_theta_o);
  sin_theta_o.Set(slot, SafeSqrt(1 - Sqr(bounds.cos_theta_o)));
  cos_theta_e.Set(slot, bounds.cos_theta_e);
  strength.Set(slot, bounds.strength);
  plane_min.Set(slot, bounds.plane_min);
  two_sided.Set(slot, bounds.two_sided ? std::bit_cast<float>(0xffffffffu) : 0);
  child[slot] = value;
}

Float4 LightTreeNode::Importance(const ReferencePoint& reference) const {
  const Float4 px(reference.p.x), py(reference.p.y), pz(reference.p.z);
  const Float4 dx = px - center_x, dy = py - center_y, dz = pz - center_z;
  const Float4 distance_squared = dx * dx + dy * dy + dz * dz;
  const Float4 inverse_distance = SafeDiv(Float4(1.0f), Sqrt(distance_squared));

  // Angle b: half the angle that the bounding sphere subtends at p; pi from inside.
  const __m128 inside = _mm_cmple_ps(distance_squared.v, radius_squared.v);
  const Float4 sin2_b = Select(inside, Float4(0.0f), SafeDiv(radius_squared, distance_squared));
  const Float4 sin_b = Sqrt(sin2_b);
  const Float4 cos_b = Select(inside, Float4(-1.0f), SafeSqrt(Float4(1.0f) - sin2_b));

  // Angle w: between the axis and the direction to p. theta' = max(0, w - theta_o - b) is the smallest angle
  // to a normal.
  Float4 cos_w = (axis_x * dx + axis_y * dy + axis_z * dz) * inverse_distance;
  cos_w = Select(two_sided.v, Abs(cos_w), cos_w);
  const Float4 sin_w = SinOf(cos_w);
  const Float4 cos_x = CosClampedDifference(cos_w, sin_w, cos_theta_o, sin_theta_o);
  const Float4 sin_x = SinClampedDifference(cos_w, sin_w, cos_theta_o, sin_theta_o);
  const Float4 cos_emitted = CosClampedDifference(cos_x, sin_x, cos_b, sin_b);

  // Inside the sphere the estimate is bounded as that of a flat emitter would be.
  const Float4 bounded_distance_squared = Max(distance_squared, radius_squared * 0.5f);
  Float4 importance = SafeDiv(strength * cos_emitted, bounded_distance_squared);
  if (reference.lobe.alpha_squared > 0) {
    const Vec3 axis = reference.lobe.axis;
    const Float4 cos_l = -(dx * axis.x + dy * axis.y + dz * axis.z) * inverse_distance;
    const Float4 cos_nearest = CosClampedDifference(cos_l, SinOf(cos_l), cos_b, sin_b);
    const Float4 sin2_size = Select(inside, Float4(1.0f), sin2_b);
    importance *= LobeWeight(reference.lobe.alpha_squared, cos_nearest, sin2_size);
  } else if (!IsZero(reference.shading_n)) {
    const Normal3 n = reference.shading_n;
    const Float4 cos_i = Abs(dx * n.x + dy * n.y + dz * n.z) * inverse_distance;
    importance *= CosClampedDifference(cos_i, SinOf(cos_i), cos_b, sin_b);
  }
  const Float4 height = axis_x * px + axis_y * py + axis_z * pz;
  const __m128 seen = _mm_and_ps(Greater(cos_emitted, cos_theta_e), _mm_cmpge_ps(height.v, plane_min.v));
  return _mm_and_ps(Max(importance, Float4(0.0f)).v, seen);
}

Float4 LightTreeNode::ImportanceAlong(const Ray& ray) const {
  const Float4 x = center_x - ray.o.x, y = center_y - ray.o.y, z = center_z - ray.o.z;
  const Float4 nearest = Max(x * ray.d.x + y * ray.d.y + z * ray.d.z, Float4(0.0f));
  const Float4 dx = x - nearest * ray.d.x, dy = y - nearest * ray.d.y, dz = z - nearest * ray.d.z;
  return SafeDiv(strength, Sqrt(dx * dx + dy * dy + dz * dz + radius_squared));
}

LightTree::LightTree(std::span<const LightBounds> bounds, std::span<const uint32_t> lights,
                     size_t light_count) {
  BuiltLightTree built = BuildLightTree(bounds, lights);
  nodes_ = std::move(built.nodes);
  parents_.resize(nodes_.size(), 0);
  places_.resize(light_count, kNowhere);
  for (uint32_t node = 0; node < nodes_.size(); ++node) {
    for (uint32_t slot = 0; slot < 4; ++slot) {
      if (nodes_[node].strength[static_cast<int>(slot)] == 0) continue;
      const uint32_t child = nodes_[node].child[slot];
      if (child & LightTreeNode::kLeaf)
        places_[child & ~LightTreeNode::kLeaf] = 4 * node + slot;
      else
        parents_[child] = 4 * node + slot;
    }
  }
}

template <typename ImportanceOf>
std::optional<ChosenLight> LightTree::ChooseBy(const ImportanceOf& importance, float u) const {
  if (nodes_.empty()) return std::nullopt;
  uint32_t node = 0;
  float pmf = 1;
  while (true) {
    alignas(16) float w[4];
    _mm_store_ps(w, importance(nodes_[node]).v);
    const float sum0 = w[0], sum1 = sum0 + w[1], sum2 = sum1 + w[2], total = sum2 + w[3];
    if (!(total > 0) || !(total <= std::numeric_limits<float>::max())) return std::nullopt;
    const float place = u * total;
    int slot = (place >= sum0) + (place >= sum1) + (place >= sum2);
    while (w[slot] == 0) --slot;  // u * total may be rounded up to total
    const float before = slot == 0 ? 0 : slot == 1 ? sum0 : slot == 2 ? sum1 : sum2;
    u = std::clamp((place - before) / w[slot], 0.0f, kOneMinusEpsilon);
    pmf *= w[slot] / total;
    const uint32_t child = nodes_[node].child[slot];
    if (child & LightTreeNode::kLeaf)
      return ChosenLight{static_cast<int>(child & ~LightTreeNode::kLeaf), pmf};
    node = child;
  }
}

template <typename ImportanceOf>
float LightTree::PmfBy(const ImportanceOf& importance, int light) const {
  float pmf = 1;
  uint32_t place = places_[light];
  while (true) {
    const uint32_t node = place / 4;
    alignas(16) float w[4];
    _mm_store_ps(w, importance(nodes_[node]).v);
    const float total = ((w[0] + w[1]) + w[2]) + w[3];
    if (!(w[place % 4] > 0) || !(total <= std::numeric_limits<float>::max())) return 0;
    pmf *= w[place % 4] / total;
    if (node == 0) return pmf;
    place = parents_[node];
  }
}

std::optional<ChosenLight> LightTree::Choose(const ReferencePoint& reference, float u) const {
  return ChooseBy([&](const LightTreeNode& node) { return node.Importance(reference); }, u);
}

float LightTree::Pmf(const ReferencePoint& reference, int light) const {
  return PmfBy([&](const LightTreeNode& node) { return node.Importance(reference); }, light);
}

std::optional<ChosenLight> LightTree::ChooseAlong(const Ray& ray, float u) const {
  return ChooseBy([&](const LightTreeNode& node) { return node.ImportanceAlong(ray); }, u);
}

float LightTree::PmfAlong(const Ray& ray, int light) const {
  return PmfBy([&](const LightTreeNode& node) { return node.ImportanceAlong(ray); }, light);
}

BoundingSphere LightTree::SphereOf(int light) const {
  const LightTreeNode& node = nodes_[places_[light] / 4];
  const int slot = static_cast<int>(places_[light] % 4);
  return {{node.center_x[slot], node.center_y[slot], node.center_z[slot]},
          std::sqrt(node.radius_squared[slot])};
}

}  // namespace tessera
