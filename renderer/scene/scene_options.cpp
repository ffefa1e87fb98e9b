#include "renderer/scene/scene_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/description/option_kinds.h"
#include "renderer/scene/scene.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// Scenes name structures of pbrt. Each is satisfied by any of ours, because none changes the picture.
constexpr Kind<std::string_view> kSceneAccelerators[] = {
    {"bvh", Support::kSupported, {}},
    {"kdtree", Support::kSupported, {}},
};
constexpr KindTable<std::string_view> kSceneAcceleratorTable("accelerator", kSceneAccelerators);

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

// Null for an option that is none.
bool* FlagOf(std::string_view name, SceneOptions* options) {
  if (name == "wavefront") return &options->wavefront;
  if (name == "disablepixeljitter") return &options->disable_pixel_jitter;
  if (name == "disablewavelengthjitter") return &options->disable_wavelength_jitter;
  if (name == "disabletexturefiltering") return &options->disable_texture_filtering;
  if (name == "forcediffuse") return &options->force_diffuse;
  return nullptr;
}

Result<void> Override(const RenderOptions& overrides, SceneOptions* options) {
  options->disable_pixel_jitter |= overrides.disable_pixel_jitter;
  options->disable_wavelength_jitter |= overrides.disable_wavelength_jitter;
  options->disable_texture_filtering |= overrides.disable_texture_filtering;
  options->force_diffuse |= overrides.force_diffuse;
  if (!overrides.displacement_edge_scale) return {};
  if (!(*overrides.displacement_edge_scale > 0))
    return BadInput("--displacement-edge-scale: must be above 0");
  options->displacement_edge_scale = *overrides.displacement_edge_scale;
  return {};
}

}  // namespace

Result<SceneOptions> ReadSceneOptions(const SceneDescription& scene, const RenderOptions& overrides,
                                      Diagnostics& diagnostics) {
  SceneOptions options;
  const KindTable<std::string_view> kinds = OptionKinds();
  for (const Parameter& option : scene.options) {
    const Kind<std::string_view>* kind = kinds.Find(option.name);
    if (kind == nullptr) return ErrorAt(option.location, kinds.Refusal(option.name));
    if (kind->support == Support::kMapped && !IsFalse(option)) {
      diagnostics.Warn(option.location,
                       fmt::format("option \"{}\" is not available and is ignored", kind->name));
    }
    if (bool* const flag = FlagOf(option.name, &options)) *flag = !IsFalse(option);
    if (option.name == "displacementedgescale") {
      options.displacement_edge_scale = option.floats.empty() ? 1 : option.floats[0];
      if (!(options.displacement_edge_scale > 0))
        return ErrorAt(option.location, "option \"displacementedgescale\" must be above 0");
    }
    if (option.name == "seed") {
      const Result<uint64_t> seed = ReadSeed(option);
      if (!seed) return seed.error();
      options.seed = *seed;
    }
  }
  if (const Result<void> overridden = Override(overrides, &options); !overridden) return overridden.error();
  return options;
}

void ScaleDisplacementEdges(float factor, SceneDescription& scene) {
  if (factor == 1) return;
  const auto scale = [factor](std::vector<ShapeDescription>& shapes) {
    for (ShapeDescription& shape : shapes) {
      if (shape.entity.kind != "plymesh") continue;
      // What is written stands before all defaults, and a later default takes precedence over this one.
      Parameter length;
      length.type = "float";
      length.name = "edgelength";
      length.location = shape.entity.location;
      length.floats = {1};
      length.is_default = true;
      std::vector<Parameter>& parameters = shape.entity.parameters;
      parameters.insert(std::ranges::find_if(parameters, &Parameter::is_default), std::move(length));
      for (Parameter& parameter : parameters) {
        if (parameter.type == "float" && parameter.name == "edgelength")
          for (float& value : parameter.floats) value *= factor;
      }
    }
  };
  scale(scene.shapes);
  for (ObjectDescription& object : scene.objects) scale(object.shapes);
}

KindList SceneAcceleratorKinds() {
  return kSceneAcceleratorTable.List();
}

Result<const Kind<AcceleratorMaker>*> ChooseAccelerator(const Entity& entity, const std::string& option) {
  if (kSceneAcceleratorTable.Find(entity.kind) == nullptr)
    return ErrorAt(entity.location, kSceneAcceleratorTable.Refusal(entity.kind));
  const KindTable<AcceleratorMaker> accelerators = Accelerators();
  if (option.empty()) return &accelerators.kinds().front();
  const Kind<AcceleratorMaker>* kind = accelerators.Find(option);
  if (kind == nullptr) return BadInput("--accelerator: " + accelerators.Refusal(option));
  return kind;
}

}  // namespace tessera
