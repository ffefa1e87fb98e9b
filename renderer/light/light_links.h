// Which lights illuminate which surfaces, and which of them cast shadows: light linking, by parameters of
// ours.
//
// A link is what a light states of the objects that it illuminates. Those of a scene are numbered: link 0 is
// that of lights that illuminate everything, and a surface has a set of links
// (SurfaceProperties::light_links).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/description/parameter_reader.h"
#include "renderer/shape/interaction.h"

namespace tessera {

constexpr size_t kLightLinksMax = 64;  // a bit of light_links each

// What is linked of a light.
struct LinkedLight {
  uint8_t link = 0;
  bool casts_shadows = true;
  bool is_hidden_from_camera = false;
  bool operator==(const LinkedLight&) const = default;
};

// Immutable once built.
class LightLinks {
 public:
  LightLinks() = default;  // of scenes that use none of it
  // `lights`: by index; empty if all are as by default. `media`: the links of points in media.
  LightLinks(std::vector<LinkedLight> lights, uint64_t media, bool any_passed)
      : lights_(std::move(lights)), media_(media), any_passed_(any_passed) {}

  // Whether any light casts no shadows.
  bool any_without_shadows() const {
    return std::ranges::any_of(lights_, [](const LinkedLight& light) { return !light.casts_shadows; });
  }
  // Whether anything differs from the default.
  bool any() const { return !lights_.empty() || any_passed_; }
  // Whether any surface but interfaces lets shadow rays pass and stops other rays.
  bool any_passed() const { return any_passed_; }
  bool Illuminates(int light, uint64_t links) const {
    return lights_.empty() || (links >> lights_[static_cast<size_t>(light)].link & 1) != 0;
  }
  bool CastsShadows(int light) const {
    return lights_.empty() || lights_[static_cast<size_t>(light)].casts_shadows;
  }
  bool IsSeenByCamera(int light) const {
    return lights_.empty() || !lights_[static_cast<size_t>(light)].is_hidden_from_camera;
  }
  uint64_t media() const { return media_; }

 private:
  std::vector<LinkedLight> lights_;
  uint64_t media_ = kAllLightLinks;
  bool any_passed_ = false;
};

// Marks parameters of a light as known that renderer/scene/ reads: of links and groups.
inline void SkipLinkParameters(ParameterReader& reader) {
  reader.FindString("group");
  for (const char* name : {"link_include", "link_exclude"}) reader.Strings(name);
  reader.Bool("cast_shadows", true);
}

}  // namespace tessera
