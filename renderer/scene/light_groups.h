// Groups of lights, each of which has a layer of its own, so that it can be graded after rendering. A light
// names its group by the parameter "string group" of its LightSource or AreaLightSource, or a rule of the
// command line does.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/film/channel.h"
#include "renderer/integrator/world.h"
#include "renderer/scene/light_group_rule.h"
#include "renderer/scene/world_builder.h"

namespace tessera {

// Immutable once made.
class LightGroups {
 public:
  // The group of lights without a group, and of what media emit.
  static constexpr std::string_view kOthers = "others";

  LightGroups() = default;
  // The first of `rules` that a light matches decides, else its own parameter. Warns of rules that match no
  // light.
  static Result<LightGroups> Read(const SceneDescription& scene, std::span<const LightGroupRule> rules,
                                  Diagnostics& diagnostics);

  // Whether any light has a group.
  bool any() const { return names_.size() > 1; }
  // In the order of their first lights, kOthers last.
  const std::vector<std::string>& names() const { return names_; }

  // Finds the lights of the world that was built from the scene, with its emitters.
  void Assign(const World& world, const std::vector<EmittingShape>& emitters);
  // Of an index into World::lights or LightPath::kMediumEmission, after Assign.
  size_t GroupOf(int light) const {
    return light < 0 ? names_.size() - 1 : of_lights_[static_cast<size_t>(light)];
  }

  void AddChannels(std::vector<Channel>& channels) const;
  // The name of one of them: "light_GROUP.R".
  static std::string ChannelName(std::string_view group, char component);

 private:
  size_t Find(const std::string& name);

  std::vector<std::string> names_{std::string(kOthers)};
  std::vector<std::string> of_sources_;                                     // by index of LightSource
  std::vector<std::pair<const ShapeDescription*, std::string>> of_shapes_;  // those that emit, by address
  std::vector<uint8_t> of_lights_;
};

}  // namespace tessera
