// From the directives of a scene to a LightTable.
#include <fmt/format.h>

#include <map>

#include "renderer/light/light_data.h"
#include "renderer/light/light_links.h"
#include "renderer/util/dispatch.h"

namespace tessera {
namespace {

// Indices of lights leave a bit free in the light tree.
constexpr size_t kLightsMax = size_t{1} << 30;
// Pixels of the pictures of all lights but area lights: each makes maps of its own, of some 20 bytes per
// pixel.
constexpr uint64_t kLightPixelsMax = uint64_t{1} << 28;

using SourceReader = SourceLight (*)(ParameterReader& reader, const LightContext& context);

template <typename Light>
SourceLight Read(ParameterReader& reader, const LightContext& context) {
  return Light::Read(reader, context);
}

SourceLight ReadInfinite(ParameterReader& reader, const LightContext& context) {
  const bool has_picture = !reader.String("filename", "").empty();
  if (has_picture && reader.Has("L"))
    reader.FailAt("L", "an infinite light takes \"L\" or \"filename\", not both");
  if (!reader.Point3s("portal").empty()) return PortalInfiniteLight::Read(reader, context);
  if (!has_picture) return ConstantInfiniteLight::Read(reader, context);
  return ImageInfiniteLight::Read(reader, context);
}

constexpr Kind<SourceReader> kSources[] = {
    {"point", Support::kSupported, Read<PointLight>},
    {"spot", Support::kSupported, Read<SpotLight>},
    {"distant", Support::kSupported, Read<DistantLight>},
    {"infinite", Support::kSupported, ReadInfinite},
    {"goniometric", Support::kSupported, Read<GoniometricLight>},
    {"projection", Support::kSupported, Read<ProjectionLight>},
};
constexpr KindTable<SourceReader> kSourceTable("light", kSources);

// A hostile scene may ask for more light than floats hold. Beyond this the choice between lights no longer
// distinguishes them; their radiance is not changed.
constexpr float kPowerMax = 1e20f;

float Bounded(float power) {
  return power < kPowerMax ? power : kPowerMax;
}

LightProfile Bounded(LightProfile profile) {
  profile.power = Bounded(profile.power);
  profile.irradiance = Bounded(profile.irradiance);
  if (profile.bounds) profile.bounds->strength = Bounded(profile.bounds->strength);
  return profile;
}

class LightBuilder {
 public:
  LightBuilder(const LightInputs& inputs, const Geometry& geometry, Diagnostics& diagnostics)
      : inputs_(inputs), geometry_(geometry), diagnostics_(diagnostics) {}

  // Adds everything to `data`, and to *area_lights the first light of each shape.
  Result<void> Build(LightTable::Data& data, std::vector<int>* area_lights);

 private:
  Result<SourceLight> ReadSource(const LightDescription& description);
  Result<void> CheckPixels() const;
  Result<void> AddSources();
  Result<void> AddAreas(std::vector<int>* area_lights);
  // Returns the first light of the emitter, or -1 if it does not emit.
  Result<int> AddArea(const EmittingShape& emitter);
  void AddSourceProfiles(std::vector<LightProfile>* profiles);

  const LightInputs& inputs_;
  const Geometry& geometry_;
  Diagnostics& diagnostics_;
  LightTable::Data* data_ = nullptr;
};

Result<SourceLight> LightBuilder::ReadSource(const LightDescription& description) {
  const Entity& entity = description.entity;
  const Kind<SourceReader>* kind = kSourceTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kSourceTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  SkipLinkParameters(reader);
  if (entity.kind == "infinite") reader.Bool("visible_camera", true);
  const bool samples_all = inputs_.samples_all || !reader.Bool("cast_shadows", true);
  SourceLight light = kind->reader(
      reader, {inputs_.render_from_world * description.world_from_light.First(), inputs_.render_from_world,
               inputs_.files, inputs_.images, diagnostics_, samples_all});
  if (const Result<void> finished = reader.Finish(); !finished) return finished.error();
  return light;
}

// A small file may use a picture for any number of lights. Files that cannot be read are left to those who
// need them.
Result<void> LightBuilder::CheckPixels() const {
  std::map<std::string, uint64_t> pixels_of;  // by file
  uint64_t pixels = 0;
  for (const LightDescription& light : inputs_.scene.lights) {
    for (const Parameter& parameter : light.entity.parameters) {
      if (parameter.name != "filename" || parameter.strings.empty() || parameter.strings[0].empty()) continue;
      const auto [file, is_new] = pixels_of.try_emplace(parameter.strings[0], 0);
      if (is_new) {
        const auto image = inputs_.images.Get(file->first, std::nullopt);
        if (image)
          file->second = static_cast<uint64_t>((*image)->width) * static_cast<uint64_t>((*image)->height);
      }
      pixels += file->second;
      if (pixels > kLightPixelsMax) {
        return ErrorAt(parameter.location,
                       fmt::format("the pictures of the lights have more than {} pixels", kLightPixelsMax));
      }
    }
  }
  return {};
}

Result<void> LightBuilder::AddSources() {
  if (Result<void> checked = CheckPixels(); !checked) return checked;
  for (const LightDescription& description : inputs_.scene.lights) {
    Result<SourceLight> light = ReadSource(description);
    if (!light) return light.error();
    if (std::holds_alternative<PortalInfiniteLight>(*light) && description.world_from_light.IsAnimated())
      return ErrorAt(description.entity.location,
                     "a light with a portal moves, expected one that stands still");
    const bool is_hit = Dispatch(*light, []<typename Light>(Light&) { return HitByRays<Light>; });
    if (is_hit) data_->infinite.push_back(static_cast<int>(data_->sources.size()));
    data_->sources.push_back(std::move(*light));
  }
  return {};
}

Result<int> LightBuilder::AddArea(const EmittingShape& emitter) {
  const Shape& shape = ShapeOf(geometry_, emitter.instance, emitter.shape);
  const Entity& entity = *emitter.description->area_light;
  if (std::holds_alternative<CurveSet>(shape.form)) {
    return ErrorAt(
        emitter.description->entity.location,
        fmt::format("a curve cannot be an area light (it has that of {})", entity.location.Text()));
  }
  if (shape.surface.is_interface) {
    diagnostics_.Warn(entity.location, "the area light of a shape with an \"interface\" material is ignored");
    return -1;
  }
  const size_t first = data_->sources.size() + data_->areas.size();
  if (first + shape.PrimitiveCount() > kLightsMax) return ErrorAt(entity.location, "too many area lights");
  if (const Result<void> added =
          data_->areas.Add(emitter, geometry_, inputs_.files, inputs_.images, diagnostics_);
      !added) {
    return added.error();
  }
  return static_cast<int>(first);
}

Result<void> LightBuilder::AddAreas(std::vector<int>* area_lights) {
  for (const EmittingShape& emitter : inputs_.emitters) {
    const Result<int> first = AddArea(emitter);
    if (!first) return first.error();
    area_lights->push_back(*first);
  }
  return {};
}

void LightBuilder::AddSourceProfiles(std::vector<LightProfile>* profiles) {
  for (size_t i = 0; i < data_->sources.size(); ++i) {
    LightProfile profile =
        Dispatch(data_->sources[i], [&](const auto& light) { return light.Profile(data_->scene_radius); });
    const AnimatedTransform& world_from_light = inputs_.scene.lights[i].world_from_light;
    if (world_from_light.IsAnimated()) {
      auto motion =
          std::make_unique<LightMotion>(inputs_.render_from_world, world_from_light, !profile.bounds);
      profile = motion->AtAllTimes(profile, geometry_.times);
      data_->motions.resize(data_->sources.size());
      data_->motions[i] = std::move(motion);
    }
    profiles->push_back(profile);
  }
}

Result<void> LightBuilder::Build(LightTable::Data& data, std::vector<int>* area_lights) {
  data_ = &data;
  if (const Result<void> added = AddSources(); !added) return added;
  if (const Result<void> added = AddAreas(area_lights); !added) return added;
  data.textures = &inputs_.textures;
  const Bounds3 bounds = geometry_.Bounds();
  data.scene_radius = bounds.empty() ? 0 : Length(bounds.Diagonal()) / 2;
  std::vector<LightProfile> profiles;
  AddSourceProfiles(&profiles);
  data.areas.AddProfiles(&profiles);
  for (LightProfile& profile : profiles) profile = Bounded(profile);
  data.chooser = LightChooser(inputs_.light_sampler, profiles);
  return {};
}

}  // namespace

Result<BuiltLights> LightTable::Build(const LightInputs& inputs, const Geometry& geometry,
                                      Diagnostics& diagnostics) {
  BuiltLights lights;
  LightBuilder builder(inputs, geometry, diagnostics);
  if (const Result<void> built = builder.Build(*lights.table.data_, &lights.area_lights); !built)
    return built.error();
  return lights;
}

KindList LightSourceKinds() {
  return kSourceTable.List();
}

}  // namespace tessera
