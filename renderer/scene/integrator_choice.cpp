#include "renderer/scene/integrator_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/description/parameter_reader.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr int kMaxDepthMax = 1 << 20;  // scattering events; roulette ends paths long before

constexpr std::string_view kKinds[] = {"path",       "volpath",       "mixture",
                                       "simplepath", "simplevolpath", "randomwalk"};
// Estimators of the same picture that we do not have: ours takes their place.
constexpr std::string_view kReplacedKinds[] = {"bdpt", "lightpath", "mlt", "sppm"};
constexpr std::string_view kRefusedKinds[] = {"ambientocclusion", "function"};

template <size_t N>
bool Contains(const std::string_view (&list)[N], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

Error UnknownIntegrator(const std::string& where, const std::string& kind) {
  if (Contains(kRefusedKinds, kind) || Contains(kReplacedKinds, kind)) {
    return BadInput(where + ": integrator \"" + kind + "\" is not supported yet");
  }
  return BadInput(where + ": unknown integrator \"" + kind + "\"" + DidYouMean(kind, kKinds));
}

// The parameters of a kind that we have.
void ReadKind(ParameterReader& reader, IntegratorChoice* choice, Diagnostics& diagnostics) {
  const Entity& entity = reader.entity();
  if (entity.kind == "simplepath") {
    choice->sample_lights = reader.Bool("samplelights", true);
    choice->sample_bsdf = reader.Bool("samplebsdf", true);
  }
  if (entity.kind != "path" && entity.kind != "volpath" && entity.kind != "mixture") return;
  static constexpr std::string_view kLightSamplers[] = {"uniform", "power", "bvh", "exhaustive"};
  choice->light_sampler = reader.Choice("lightsampler", "bvh", kLightSamplers);
  if (choice->light_sampler == "exhaustive")
    reader.FailAt("lightsampler", "\"exhaustive\" is not supported yet");
  if (entity.kind != "mixture" && reader.Bool("regularize", false)) {
    diagnostics.Warn(entity.location, "\"regularize\" is not available: the picture is not biased by it");
  }
}

// The command line's word over the scene's.
Result<void> Override(const RenderOptions& options, IntegratorChoice* choice) {
  if (!options.integrator.empty()) {
    if (!Contains(kKinds, options.integrator)) return UnknownIntegrator("--integrator", options.integrator);
    choice->name = options.integrator;
  }
  if (options.max_depth) {
    if (*options.max_depth < 0 || *options.max_depth > kMaxDepthMax) {
      return BadInput(fmt::format("--max-depth: must lie between 0 and {}", kMaxDepthMax));
    }
    choice->max_depth = *options.max_depth;
  }
  return {};
}

}  // namespace

Result<IntegratorChoice> ChooseIntegrator(const SceneDescription& scene, const RenderOptions& options,
                                          Diagnostics& diagnostics) {
  const Entity& entity = scene.integrator;
  IntegratorChoice choice;
  choice.name = entity.kind;
  ParameterReader reader(entity);
  choice.max_depth = reader.Integer("maxdepth", 5);
  if (choice.max_depth < 0 || choice.max_depth > kMaxDepthMax) {
    reader.FailAt("maxdepth", fmt::format("maxdepth must lie between 0 and {}", kMaxDepthMax));
  }
  if (Contains(kReplacedKinds, entity.kind)) {
    reader.IgnoreRest();
    choice.name = "volpath";
    diagnostics.Warn(
        entity.location,
        "integrator \"" + entity.kind +
            "\" is not available: \"volpath\", which converges to the same picture, renders instead");
  } else if (!Contains(kKinds, entity.kind)) {
    return UnknownIntegrator(entity.location.Text(), entity.kind);
  } else {
    ReadKind(reader, &choice, diagnostics);
  }
  if (Result<void> done = reader.Finish(); !done) return done.error();
  if (Result<void> overridden = Override(options, &choice); !overridden) return overridden.error();
  return choice;
}

}  // namespace tessera
