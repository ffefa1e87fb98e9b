#include "renderer/scene/scene_options.h"

#include <algorithm>

#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kNames[] = {"disablepixeljitter",
                                       "disabletexturefiltering",
                                       "disablewavelengthjitter",
                                       "displacementedgescale",
                                       "forcediffuse",
                                       "msereferenceimage",
                                       "msereferenceout",
                                       "pixelstats",
                                       "rendercoordsys",
                                       "seed",
                                       "wavefront"};
// These change how pbrt works, not what it computes.
constexpr std::string_view kWithoutEffect[] = {"rendercoordsys", "wavefront", "pixelstats"};

template <size_t N>
bool Contains(const std::string_view (&list)[N], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

Result<uint64_t> ReadSeed(const Parameter& option) {
  if (option.integers.size() == 1) return static_cast<uint64_t>(static_cast<int64_t>(option.integers[0]));
  if (option.floats.size() == 1 && option.floats[0] == std::floor(option.floats[0])) {
    return static_cast<uint64_t>(static_cast<int64_t>(option.floats[0]));
  }
  return ErrorAt(option.location, "option \"seed\" takes one integer");
}

bool IsFalse(const Parameter& option) {
  return option.bools.size() == 1 && !option.bools[0];
}

}  // namespace

Result<SceneOptions> ReadSceneOptions(const SceneDescription& scene, Diagnostics& diagnostics) {
  SceneOptions options;
  for (const Parameter& option : scene.options) {
    if (!Contains(kNames, option.name)) {
      return ErrorAt(option.location,
                     "unknown option \"" + option.name + "\"" + DidYouMean(option.name, kNames));
    }
    if (option.name == "wavefront") {
      options.wavefront = !IsFalse(option);
    } else if (option.name == "seed") {
      const Result<uint64_t> seed = ReadSeed(option);
      if (!seed) return seed.error();
      options.seed = *seed;
    } else if (!Contains(kWithoutEffect, option.name) && !IsFalse(option)) {
      diagnostics.Warn(option.location,
                       std::string("option \"") + option.name + "\" is not available and is ignored");
    }
  }
  return options;
}

Result<std::string> ChooseAccelerator(const Entity& entity, const std::string& option) {
  static constexpr std::string_view kSceneKinds[] = {"bvh", "kdtree"};
  static constexpr std::string_view kOurKinds[] = {"embree", "bvh", "list"};
  if (!Contains(kSceneKinds, entity.kind)) {
    return ErrorAt(entity.location,
                   "unknown accelerator \"" + entity.kind + "\"" + DidYouMean(entity.kind, kSceneKinds));
  }
  if (option.empty()) return std::string("embree");
  if (!Contains(kOurKinds, option)) return BadInput("--accelerator: unknown accelerator \"" + option + "\"");
  return option;
}

}  // namespace tessera
