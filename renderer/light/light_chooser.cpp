#include "light/light_chooser.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

}  // namespace

LightChooser::LightChooser(Method method, const std::vector<LightProfile>& profiles) : method_(method) {
  std::vector<uint32_t> placed;
  std::vector<LightBounds> bounds;
  for (uint32_t i = 0; i < profiles.size(); ++i) {
    const LightProfile& profile = profiles[i];
    if (!profile.is_sampled || !(profile.power > 0)) continue;
    if (method == Method::kTree && profile.bounds) {
      placed.push_back(i);
      bounds.push_back(*profile.bounds);
    } else {
      candidates_.push_back(i);
    }
  }
  if (placed.size() == 1 && candidates_.empty()) candidates_.swap(placed);  // nothing to choose
  places_.assign(profiles.size(), kNowhere);
  for (uint32_t i = 0; i < candidates_.size(); ++i) places_[candidates_[i]] = i;
  if (!placed.empty()) tree_ = LightTree(bounds, placed, profiles.size());
  const float candidate_count = static_cast<float>(candidates_.size());
  if (!tree_.empty()) candidates_pmf_ = candidate_count / (candidate_count + 1);
  if (method == Method::kPower && !candidates_.empty()) {
    std::vector<float> powers;
    for (const uint32_t light : candidates_) powers.push_back(profiles[light].power);
    power_ = Distribution1D(powers);
  }
}

std::optional<ChosenLight> LightChooser::ChooseByTree(const ReferencePoint& reference, float u) const {
  u = std::clamp((u - candidates_pmf_) / (1 - candidates_pmf_), 0.0f, kOneMinusEpsilon);
  std::optional<ChosenLight> chosen = tree_.Choose(reference.p, reference.shading_n, u);
  if (chosen) chosen->pmf *= 1 - candidates_pmf_;
  return chosen;
}

std::optional<ChosenLight> LightChooser::Choose(const ReferencePoint& reference, float u) const {
  if (candidates_.size() == 1 && tree_.empty()) return ChosenLight{static_cast<int>(candidates_[0]), 1};
  if (u >= candidates_pmf_ || candidates_.empty())
    return tree_.empty() ? std::nullopt : ChooseByTree(reference, u);
  if (method_ == Method::kPower) {
    const Distribution1D::Drawn drawn = power_.Sample(u);
    return ChosenLight{static_cast<int>(candidates_[drawn.cell]), power_.Pmf(drawn.cell)};
  }
  const float count = static_cast<float>(candidates_.size());
  const size_t place = std::min(static_cast<size_t>(u / candidates_pmf_ * count), candidates_.size() - 1);
  return ChosenLight{static_cast<int>(candidates_[place]), candidates_pmf_ / count};
}

float LightChooser::Pmf(const ReferencePoint& reference, int light) const {
  const uint32_t place = places_[light];
  if (place == kNowhere) {
    if (!tree_.Contains(light)) return 0;
    return tree_.Pmf(reference.p, reference.shading_n, light) * (1 - candidates_pmf_);
  }
  if (method_ == Method::kPower) return power_.Pmf(place);
  return candidates_pmf_ / static_cast<float>(candidates_.size());
}

}  // namespace tessera
