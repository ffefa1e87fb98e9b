// What the directives of a scene state of light links: parameters of ours (renderer/light/light_links.h).
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "renderer/description/diagnostics.h"
#include "renderer/description/scene_description.h"
#include "renderer/integrator/world.h"

namespace tessera {

// Of a scene whose world is being built.
class SceneLinks {
 public:
  SceneLinks() = default;  // of a scene that uses none of it
  // Reads the parameters of all lights. The scene must outlive this.
  static Result<SceneLinks> Read(const SceneDescription& scene);

  // The links of what is called by any of these names; empty ones do not count.
  uint64_t LinksOf(std::span<const std::string> names);
  // The same of a shape, in the object definition of this name if it is not empty.
  uint64_t LinksOf(const ShapeDescription& shape, const std::string& object);
  // Of a world whose lights and shapes are complete. Warns of names that no object has.
  LightLinks Assign(const World& world, std::span<const EmittingShape> emitters, Diagnostics& diagnostics);

 private:
  // Some lights illuminate the objects that match any pattern of `include`, or all if there is none, but not
  // those that match any of `exclude`.
  struct Pattern {
    std::string text;
    bool has_matched = false;
  };
  struct Link {
    SourceLocation location;  // of the first light
    std::vector<Pattern> include, exclude;
  };
  Result<LinkedLight> ReadLight(const Entity& light);
  static bool Matches(std::vector<Pattern>& patterns, std::span<const std::string> names);

  const SceneDescription* scene_ = nullptr;
  std::vector<Link> links_;                                // numbered from 1
  std::vector<LinkedLight> sources_;                       // of LightSource directives
  std::map<const ShapeDescription*, LinkedLight> shapes_;  // that emit
  std::map<std::vector<std::string>, uint64_t> known_;     // links by names
};

}  // namespace tessera
