#include "renderer/scene/integrator_choice.h"

#include <fmt/format.h>

#include "renderer/description/parameter_reader.h"

namespace tessera {
namespace {

constexpr int kMaxDepthMax = 1 << 20;  // scattering events; roulette ends paths long before

// Whether an integrator of pbrt estimates something else than radiance.
bool ShowsOtherThanRadiance(std::string_view name) {
  return name == "ambientocclusion" || name == "function";
}

void ReadLightSampler(ParameterReader& reader, IntegratorChoice* choice, Diagnostics& diagnostics) {
  const std::string name = reader.String("lightsampler", "bvh");
  const Kind<LightSamplerKind>* kind = LightSamplers().Find(name);
  if (kind == nullptr) {
    diagnostics.Warn(reader.LocationOf("lightsampler"),
                     fmt::format("{}; \"bvh\" is used, as in pbrt", LightSamplers().Refusal(name)));
    return;
  }
  choice->light_sampler = kind->reader;
  if (kind->support == Support::kMapped) {
    diagnostics.Warn(
        reader.LocationOf("lightsampler"),
        fmt::format("light sampler \"{}\" is not available: \"{}\", which chooses the same lights "
                    "with less work, is used instead",
                    kind->name, kind->instead));
  }
}

// The parameters of a supported kind.
void ReadKind(ParameterReader& reader, IntegratorChoice* choice, Diagnostics& diagnostics) {
  switch (choice->integrator.kind) {
    case IntegratorKind::kPath:
    case IntegratorKind::kVolPath:
      ReadLightSampler(reader, choice, diagnostics);
      choice->regularize = reader.Bool("regularize", false);
      break;
    case IntegratorKind::kMixture: ReadLightSampler(reader, choice, diagnostics); break;
    case IntegratorKind::kSimplePath:
      choice->sample_lights = reader.Bool("samplelights", true);
      choice->sample_bsdf = reader.Bool("samplebsdf", true);
      break;
    case IntegratorKind::kSimpleVolPath:
    case IntegratorKind::kRandomWalk: break;
  }
}

// The command line takes precedence over the scene.
Result<void> Override(const RenderOptions& options, IntegratorChoice* choice) {
  if (!options.integrator.empty()) {
    const Kind<IntegratorTraits>* kind = Integrators().Find(options.integrator);
    if (kind == nullptr || kind->support != Support::kSupported)
      return BadInput("--integrator: " + Integrators().Refusal(options.integrator));
    const bool is_other = kind->reader.kind != choice->integrator.kind;
    if (is_other) choice->sample_lights = choice->sample_bsdf = true;  // of the scene's integrator alone
    choice->integrator = kind->reader;
    choice->name = kind->name;
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
  const Kind<IntegratorTraits>* kind = Integrators().Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, Integrators().Refusal(entity.kind));
  IntegratorChoice choice;
  choice.integrator = kind->reader;
  choice.name = kind->support == Support::kMapped ? kind->instead : kind->name;
  ParameterReader reader(entity);
  choice.max_depth = reader.Integer("maxdepth", 5);
  if (choice.max_depth < 0 || choice.max_depth > kMaxDepthMax) {
    reader.FailAt("maxdepth", fmt::format("maxdepth must lie between 0 and {}", kMaxDepthMax));
  }
  if (kind->support == Support::kMapped) {
    reader.IgnoreRest();
    const std::string_view picture = ShowsOtherThanRadiance(kind->name)
                                         ? "which shows radiance and so another picture"
                                         : "which converges to the same picture";
    diagnostics.Warn(entity.location,
                     fmt::format("integrator \"{}\" is not available: \"{}\", {}, renders instead",
                                 kind->name, kind->instead, picture));
  } else {
    ReadKind(reader, &choice, diagnostics);
  }
  if (Result<void> done = reader.Finish(); !done) return done.error();
  if (Result<void> overridden = Override(options, &choice); !overridden) return overridden.error();
  return choice;
}

}  // namespace tessera
