#include "renderer/light/light_chooser.h"

#include <algorithm>

#include "renderer/util/hash.h"

namespace tessera {
namespace {

// The share of the probability that is distributed evenly, not by estimates that ignore occlusion. No light
// is less probable than this times an even share.
constexpr float kEvenShare = 0.5f;

bool IsSampled(const LightProfile& profile) {
  return profile.is_sampled && profile.power > 0;
}

std::vector<float> Weights(LightSamplerKind kind, const std::vector<LightProfile>& profiles,
                           const std::vector<uint32_t>& candidates) {
  const float count = static_cast<float>(candidates.size());
  float irradiance = 0;
  for (const uint32_t light : candidates) irradiance += profiles[light].irradiance;
  std::vector<float> weights;
  for (const uint32_t light : candidates) {
    const LightProfile& profile = profiles[light];
    float weight = 1 / count;
    if (kind == LightSamplerKind::kPower) weight = profile.power;
    if (kind == LightSamplerKind::kTree && irradiance > 0) {
      weight = kEvenShare / count + (1 - kEvenShare) * profile.irradiance / irradiance;
    }
    weights.push_back(weight);
  }
  return weights;
}

constexpr Kind<LightSamplerKind> kLightSamplers[] = {
    {"uniform", Support::kSupported, LightSamplerKind::kUniform},
    {"power", Support::kSupported, LightSamplerKind::kPower},
    {"bvh", Support::kSupported, LightSamplerKind::kTree},
    // The same choice, by the importance of every light instead of a tree of them.
    {"exhaustive", Support::kMapped, LightSamplerKind::kTree, "bvh"},
};

}  // namespace

KindTable<LightSamplerKind> LightSamplers() {
  return {"light sampler", kLightSamplers};
}

LightChooser::LightChooser(LightSamplerKind kind, const std::vector<LightProfile>& profiles) {
  std::vector<uint32_t> placed;
  std::vector<LightBounds> bounds;
  for (uint32_t i = 0; i < profiles.size(); ++i) {
    const LightProfile& profile = profiles[i];
    if (!IsSampled(profile)) continue;
    if (kind == LightSamplerKind::kTree && profile.bounds) {
      placed.push_back(i);
      bounds.push_back(*profile.bounds);
    } else {
      candidates_.push_back(i);
      irradiance_ += profile.irradiance;
    }
  }
  if (placed.size() == 1 && candidates_.empty()) {  // nothing to choose
    candidates_.swap(placed);
    lone_light_ = static_cast<int>(candidates_[0]);
    lone_sphere_ = SphereAround(bounds[0].box);
  }
  places_.assign(profiles.size(), kNowhere);
  for (uint32_t i = 0; i < candidates_.size(); ++i) places_[candidates_[i]] = i;
  if (!candidates_.empty()) choice_ = Distribution1D(Weights(kind, profiles, candidates_));
  if (!placed.empty()) tree_ = LightTree(bounds, placed, profiles.size());
}

float LightChooser::TreeShare(const ReferencePoint& reference) const {
  if (tree_.empty()) return 0;
  if (candidates_.empty()) return 1;
  const float arriving = tree_.Importance(reference);
  if (!(arriving > 0)) return 0;
  const float even = 1 / (static_cast<float>(candidates_.size()) + 1);
  return kEvenShare * even + (1 - kEvenShare) * arriving / (arriving + irradiance_);
}

std::optional<ChosenLight> LightChooser::Choose(const ReferencePoint& reference, float u) const {
  if (const std::optional<ChosenLight> only = OnlyLight()) return only;
  const float tree_share = TreeShare(reference);
  if (u < tree_share) {
    u = std::min(u / tree_share, kOneMinusEpsilon);
    std::optional<ChosenLight> chosen = tree_.Choose(reference, u);
    if (chosen) chosen->pmf *= tree_share;
    return chosen;
  }
  if (candidates_.empty()) return std::nullopt;
  const Distribution1D::Drawn drawn =
      choice_.Sample(std::min((u - tree_share) / (1 - tree_share), kOneMinusEpsilon));
  return ChosenLight{static_cast<int>(candidates_[drawn.cell]), (1 - tree_share) * choice_.Pmf(drawn.cell)};
}

float LightChooser::TreeShareAlong(const Ray& ray, float extinction) const {
  if (!(irradiance_ > 0)) return 1;
  const float scattered = extinction * tree_.ImportanceAlong(ray);
  return scattered / (scattered + irradiance_);
}

std::optional<ChosenLight> LightChooser::ChooseAlong(const Ray& ray, float extinction, float u) const {
  if (lone_light_ >= 0) return ChosenLight{lone_light_, 1};
  const float share = TreeShareAlong(ray, extinction);
  if (!(u < share)) return std::nullopt;
  std::optional<ChosenLight> chosen = tree_.ChooseAlong(ray, std::min(u / share, kOneMinusEpsilon));
  if (chosen) chosen->pmf *= share;
  return chosen;
}

float LightChooser::PmfAlong(const Ray& ray, float extinction, int light) const {
  if (light == lone_light_) return 1;
  if (!tree_.Contains(light)) return 0;
  return TreeShareAlong(ray, extinction) * tree_.PmfAlong(ray, light);
}

float LightChooser::Pmf(const ReferencePoint& reference, int light) const {
  const uint32_t place = places_[light];
  if (place != kNowhere) return (1 - TreeShare(reference)) * choice_.Pmf(place);
  if (!tree_.Contains(light)) return 0;
  return TreeShare(reference) * tree_.Pmf(reference, light);
}

}  // namespace tessera
