// Chooses one light of many for a point. Three ways, the scene's choice: all alike, by power, or by a tree
// over places and directions beside which every light at infinity has the chance of the whole tree.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "renderer/light/light_bounds.h"
#include "renderer/light/light_tree.h"
#include "renderer/math/distribution.h"

namespace tessera {

// What the chooser must know of a light.
struct LightProfile {
  bool is_sampled = true;             // false: never to be chosen
  float power = 0;                    // emitted by the light, not negative
  std::optional<LightBounds> bounds;  // nothing: a light at infinity
  float irradiance = 0;               // of a light at infinity, on a surface that faces it
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

  // The chance that the tree is asked, not `candidates_`.
  float TreeShare(const ReferencePoint& reference) const;

  std::vector<uint32_t> candidates_;  // lights that are chosen without a tree
  std::vector<uint32_t> places_;      // of each light in candidates_, or kNowhere
  Distribution1D choice_;             // over candidates_
  float irradiance_ = 0;              // of all candidates_ beside a tree
  LightTree tree_;
};

}  // namespace tessera
