#include "renderer/scene/scene_links.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/description/parameter_reader.h"
#include "renderer/scene/light_group_rule.h"
#include "renderer/scene/matte_names.h"

namespace tessera {
namespace {

// Of one parameter: every shape is compared with all of them.
constexpr size_t kLinkPatternsMax = 1000;

std::vector<std::string> ReadPatterns(ParameterReader& reader, std::string_view name) {
  std::vector<std::string> patterns = reader.Strings(name);
  if (patterns.size() > kLinkPatternsMax) {
    reader.FailAt(name, fmt::format("\"{}\" has {} names, expected at most {}; \"*\" stands for any text",
                                    name, patterns.size(), kLinkPatternsMax));
    return {};
  }
  for (std::string& pattern : patterns) pattern = MatteName(pattern);
  return patterns;
}

}  // namespace

Result<LinkedLight> SceneLinks::ReadLight(const Entity& light) {
  ParameterReader reader(light);
  LinkedLight linked;
  linked.casts_shadows = reader.Bool("cast_shadows", true);
  if (light.kind == "infinite") linked.is_hidden_from_camera = !reader.Bool("visible_camera", true);
  const std::vector<std::string> include = ReadPatterns(reader, "link_include");
  const std::vector<std::string> exclude = ReadPatterns(reader, "link_exclude");
  if (reader.failed()) return reader.Finish().error();
  if (include.empty() && exclude.empty()) return linked;
  const auto same = [](const std::vector<Pattern>& patterns, const std::vector<std::string>& texts) {
    return std::ranges::equal(patterns, texts, {}, &Pattern::text);
  };
  const auto found = std::ranges::find_if(
      links_, [&](const Link& link) { return same(link.include, include) && same(link.exclude, exclude); });
  linked.link = static_cast<uint8_t>(found - links_.begin() + 1);
  if (found != links_.end()) return linked;
  if (links_.size() + 1 == kLightLinksMax) {
    return ErrorAt(light.location,
                   fmt::format("the scene has more than {} different light links; lights that "
                               "illuminate the same objects need only one",
                               kLightLinksMax - 1));
  }
  Link link{light.location, {}, {}};
  for (const std::string& text : include) link.include.push_back({text});
  for (const std::string& text : exclude) link.exclude.push_back({text});
  links_.push_back(std::move(link));
  return linked;
}

Result<SceneLinks> SceneLinks::Read(const SceneDescription& scene) {
  SceneLinks links;
  links.scene_ = &scene;
  for (const LightDescription& light : scene.lights) {
    Result<LinkedLight> linked = links.ReadLight(light.entity);
    if (!linked) return linked.error();
    links.sources_.push_back(*linked);
  }
  const auto add = [&](const ShapeDescription& shape) -> Result<void> {
    if (!shape.area_light) return {};
    Result<LinkedLight> linked = links.ReadLight(*shape.area_light);
    if (!linked) return linked.error();
    if (*linked != LinkedLight()) links.shapes_.emplace(&shape, *linked);
    return {};
  };
  for (const ShapeDescription& shape : scene.shapes) {
    if (Result<void> added = add(shape); !added) return added.error();
  }
  return links;
}

bool SceneLinks::Matches(std::vector<Pattern>& patterns, std::span<const std::string> names) {
  bool any = false;
  for (Pattern& pattern : patterns) {
    const bool matches = std::ranges::any_of(
        names, [&](const std::string& name) { return !name.empty() && MatchesPattern(pattern.text, name); });
    pattern.has_matched |= matches;
    any |= matches;
  }
  return any;
}

uint64_t SceneLinks::LinksOf(std::span<const std::string> names) {
  uint64_t links = kAllLightLinks;
  for (size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    const bool is_included = Matches(link.include, names) || link.include.empty();
    const bool is_excluded = Matches(link.exclude, names);
    if (!is_included || is_excluded) links &= ~(uint64_t{1} << (i + 1));
  }
  return links;
}

uint64_t SceneLinks::LinksOf(const ShapeDescription& shape, const std::string& object) {
  if (links_.empty()) return kAllLightLinks;
  ParameterReader reader(shape.entity);
  std::vector<std::string> names;
  for (const char* name : {"name", "asset"}) names.push_back(MatteName(reader.FindString(name).value_or("")));
  names.push_back(MatteName(object));
  const auto [found, is_new] = known_.try_emplace(names, kAllLightLinks);
  if (is_new) found->second = LinksOf(names);
  return found->second;
}

LightLinks SceneLinks::Assign(const World& world, std::span<const EmittingShape> emitters,
                              Diagnostics& diagnostics) {
  std::vector<LinkedLight> lights(sources_);
  lights.resize(world.lights.size());
  for (const EmittingShape& emitter : emitters) {
    const auto linked = shapes_.find(emitter.description);
    const Shape& shape = ShapeOf(world.geometry, emitter.instance, emitter.shape);
    if (linked == shapes_.end() || shape.surface.area_light < 0) continue;
    std::fill_n(lights.begin() + shape.surface.area_light, shape.PrimitiveCount(), linked->second);
  }
  for (const Link& link : links_) {
    for (const auto* patterns : {&link.include, &link.exclude}) {
      for (const Pattern& pattern : *patterns) {
        if (pattern.has_matched) continue;
        diagnostics.Warn(link.location,
                         fmt::format("light link: no shape, asset or object is called \"{}\"", pattern.text));
      }
    }
  }
  const bool any =
      std::ranges::any_of(lights, [](const LinkedLight& light) { return light != LinkedLight(); });
  return LightLinks(any ? std::move(lights) : std::vector<LinkedLight>(), LinksOf({}),
                    world.passes_shadow_rays);
}

}  // namespace tessera
