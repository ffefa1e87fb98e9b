#include "renderer/scene/light_groups.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "renderer/description/parameter_reader.h"

namespace tessera {
namespace {

// What rules call a light.
using Labels = std::vector<std::string>;

Labels LabelsOf(const LightDescription& light) {
  return {light.entity.kind, light.entity.location.Text()};
}

Labels LabelsOf(const ShapeDescription& shape) {
  Labels labels{"area", shape.area_light->location.Text(), shape.entity.location.Text()};
  if (!shape.material.name.empty()) labels.push_back(shape.material.name);
  ParameterReader reader(shape.entity);
  if (auto name = reader.FindString("name")) labels.push_back(*std::move(name));
  return labels;
}

// Chooses groups and notes which rules match anything.
class Chooser {
 public:
  explicit Chooser(std::span<const LightGroupRule> rules) : rules_(rules), has_matched_(rules.size()) {}

  // The name of the group of a light; empty if it has none.
  Result<std::string> GroupOf(const Entity& entity, const Labels& labels) {
    labels_.insert(labels.front());
    std::string chosen;
    for (size_t i = 0; i < rules_.size(); ++i) {
      const auto matches = [&](const std::string& label) { return MatchesPattern(rules_[i].pattern, label); };
      if (std::ranges::none_of(labels, matches)) continue;
      has_matched_[i] = true;
      if (chosen.empty()) chosen = rules_[i].group;
    }
    ParameterReader reader(entity);
    const std::optional<std::string> own = reader.FindString("group");
    if (!own) return chosen;
    if (auto named = CheckLightGroupName(*own); !named)
      return ErrorAt(reader.LocationOf("group"), named.error().message);
    return chosen.empty() ? *own : chosen;
  }

  void WarnOfUnmatched(Diagnostics& diagnostics) const {
    for (size_t i = 0; i < rules_.size(); ++i) {
      if (has_matched_[i]) continue;
      diagnostics.Warn(
          fmt::format("--light-group {}={}", rules_[i].group, rules_[i].pattern),
          fmt::format("no light matches; a light is called by its kind ({}), by FILE:LINE:COLUMN of its "
                      "directive or of its shape, or by the name of its shape or of its material",
                      labels_.empty() ? "the scene has none" : fmt::format("{}", fmt::join(labels_, ", "))));
    }
  }

 private:
  std::span<const LightGroupRule> rules_;
  std::vector<bool> has_matched_;
  std::set<std::string> labels_;  // kinds of lights
};

}  // namespace

size_t LightGroups::Find(const std::string& name) {
  const auto found = std::ranges::find(names_, name.empty() ? kOthers : std::string_view(name));
  const auto index = static_cast<size_t>(found - names_.begin());
  // Before the others.
  if (found == names_.end())
    return static_cast<size_t>(names_.insert(names_.end() - 1, name) - names_.begin());
  return index;
}

Result<LightGroups> LightGroups::Read(const SceneDescription& scene, std::span<const LightGroupRule> rules,
                                      Diagnostics& diagnostics) {
  LightGroups groups;
  Chooser chooser(rules);
  for (const LightDescription& light : scene.lights) {
    auto group = chooser.GroupOf(light.entity, LabelsOf(light));
    if (!group) return group.error();
    groups.Find(*group);
    groups.of_sources_.push_back(*std::move(group));
  }
  const auto add_shape = [&](const ShapeDescription& shape) -> Result<void> {
    if (!shape.area_light) return {};
    auto group = chooser.GroupOf(*shape.area_light, LabelsOf(shape));
    if (!group) return group.error();
    groups.Find(*group);
    groups.of_shapes_.emplace_back(&shape, *std::move(group));
    return {};
  };
  for (const ShapeDescription& shape : scene.shapes) {
    if (auto added = add_shape(shape); !added) return added.error();
  }
  if (groups.names_.size() > kLightGroupsMax)
    return BadInput(fmt::format("the scene has {} light groups, expected at most {}",
                                groups.names_.size() - 1, kLightGroupsMax - 1));
  std::ranges::sort(groups.of_shapes_, {}, &std::pair<const ShapeDescription*, std::string>::first);
  chooser.WarnOfUnmatched(diagnostics);
  return groups;
}

void LightGroups::Assign(const World& world, const std::vector<EmittingShape>& emitters) {
  if (!any()) return;
  of_lights_.assign(world.lights.size(), static_cast<uint8_t>(names_.size() - 1));
  for (size_t i = 0; i < of_sources_.size(); ++i) of_lights_[i] = static_cast<uint8_t>(Find(of_sources_[i]));
  for (const EmittingShape& emitter : emitters) {
    const auto named = std::ranges::lower_bound(of_shapes_, emitter.description, {},
                                                &std::pair<const ShapeDescription*, std::string>::first);
    if (named == of_shapes_.end() || named->first != emitter.description) continue;
    const Shape& shape = ShapeOf(world.geometry, emitter.instance, emitter.shape);
    if (shape.surface.area_light < 0) continue;
    const auto group = static_cast<uint8_t>(Find(named->second));
    std::fill_n(of_lights_.begin() + shape.surface.area_light, shape.PrimitiveCount(), group);
  }
}

std::string LightGroups::ChannelName(std::string_view group, char component) {
  return fmt::format("light_{}.{}", group, component);
}

void LightGroups::AddChannels(std::vector<Channel>& channels) const {
  for (const std::string& name : names_) {
    for (const char component : {'R', 'G', 'B'}) AddChannel(channels, {ChannelName(name, component)});
  }
}

}  // namespace tessera
