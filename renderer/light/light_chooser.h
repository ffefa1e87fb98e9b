// Chooses one light of many for a point, by the method that the scene asks for: all lights alike, by power,
// or by a tree over positions and directions beside which every light at infinity is as probable as the whole
// tree.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/light/light_bounds.h"
#include "renderer/light/light_choice.h"
#include "renderer/light/light_tree.h"
#include "renderer/math/distribution.h"

namespace tessera {

// What the choice between lights depends on.
struct LightProfile {
  bool is_sampled = true;             // false: never to be chosen
  float power = 0;                    // emitted by the light, not negative
  std::optional<LightBounds> bounds;  // nullopt: a light at infinity
  float irradiance = 0;               // of a light at infinity, on a surface that faces it
};

class LightChooser {
 public:
  LightChooser() = default;
  // One profile for each light.
  LightChooser(LightSamplerKind kind, const std::vector<LightProfile>& profiles);

  // Returns nullopt if no light can contribute. The probabilities sum to 1, or to less where the tree finds
  // that nothing arrives.
  std::optional<ChosenLight> Choose(const ReferencePoint& reference, float u) const;
  // What Choose returns, if that does not depend on its arguments; nullopt if it does.
  std::optional<ChosenLight> OnlyLight() const {
    if (candidates_.size() != 1 || !tree_.empty()) return std::nullopt;
    return ChosenLight{static_cast<int>(candidates_[0]), 1};
  }
  float Pmf(const ReferencePoint& reference, int light) const;

  // Around a light that has a place; nullopt for lights at infinity, and for all lights unless they are
  // chosen by a tree.
  std::optional<BoundingSphere> SphereOf(int light) const {
    if (light == lone_light_) return lone_sphere_;
    if (!tree_.Contains(light)) return std::nullopt;
    return tree_.SphereOf(light);
  }
  bool has_spheres() const { return lone_light_ >= 0 || !tree_.empty(); }
  // Chooses one of the lights that have a sphere, for what a medium with this extinction (per scene unit)
  // scatters along a ray. Returns nullopt with the probability that others light the ray.
  std::optional<ChosenLight> ChooseAlong(const Ray& ray, float extinction, float u) const;
  float PmfAlong(const Ray& ray, float extinction, int light) const;
  size_t bytes() const { return tree_.bytes() + (candidates_.size() + places_.size()) * sizeof(uint32_t); }

 private:
  static constexpr uint32_t kNowhere = 0xffffffffu;

  // The probability of choosing from the tree and not from `candidates_`.
  float TreeShare(const ReferencePoint& reference) const;
  // The same for a medium along a ray.
  float TreeShareAlong(const Ray& ray, float extinction) const;

  std::vector<uint32_t> candidates_;  // lights that are chosen without a tree
  std::vector<uint32_t> places_;      // of each light in candidates_, or kNowhere
  Distribution1D choice_;             // over candidates_
  float irradiance_ = 0;              // of all candidates_ beside a tree
  LightTree tree_;
  int lone_light_ = -1;  // the only candidate, instead of a tree of one light
  BoundingSphere lone_sphere_;
};

}  // namespace tessera
