// Chooses one light of many for a point. Three ways, the scene's choice: all alike, by power, or by a tree
// over places and directions beside which every light at infinity has the chance of the whole tree.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "light/light_bounds.h"
#include "light/light_tree.h"
#include "math/distribution.h"

namespace tessera {

// What the chooser must know of a light.
struct LightProfile {
  bool is_sampled = true;             // false: never to be chosen
  float power = 0;                    // emitted by the light, not negative
  std::optional<LightBounds> bounds;  // nothing: a light at infinity
};

class LightChooser {
 public:
  enum class Method { kUniform, kPower, kTree };

  LightChooser() = default;
  // One profile for each light.
  LightChooser(Method method, const std::vector<LightProfile>& profiles);

  // The lights that are to be sampled have total probability at most 1; less where the tree finds that
  // nothing arrives.
  std::optional<ChosenLight> Choose(const ReferencePoint& reference, float u) const;
  float Pmf(const ReferencePoint& reference, int light) const;
  size_t bytes() const { return tree_.bytes() + (candidates_.size() + places_.size()) * sizeof(uint32_t); }

 private:
  static constexpr uint32_t kNowhere = 0xffffffffu;

  std::optional<ChosenLight> ChooseByTree(const ReferencePoint& reference, float u) const;

  Method method_ = Method::kUniform;
  // The lights that are chosen without a tree: all, or with a tree those at infinity.
  std::vector<uint32_t> candidates_;
  std::vector<uint32_t> places_;  // of each light in candidates_, or kNowhere
  Distribution1D power_;          // over candidates_
  LightTree tree_;
  float candidates_pmf_ = 1;  // the chance that one of candidates_ is taken; the rest is the tree's
};

}  // namespace tessera
