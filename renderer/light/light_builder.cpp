// From the directives of a scene to a LightTable.
#include <array>

#include "renderer/light/light_data.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 6> kLightKinds = {"point",    "spot",        "distant",
                                                         "infinite", "goniometric", "projection"};
constexpr std::array<std::string_view, 4> kLightSamplers = {"uniform", "power", "bvh", "exhaustive"};
// Indices of lights leave a bit free in the light tree.
constexpr size_t kLightsMax = size_t{1} << 30;

class LightBuilder {
 public:
  LightBuilder(const LightInputs& inputs, Geometry& geometry, Diagnostics& diagnostics)
      : inputs_(inputs), geometry_(geometry), diagnostics_(diagnostics) {}

  // Adds everything to `data`.
  Result<void> Build(LightTable::Data& data);

 private:
  Result<SourceLight> ReadSource(const LightDescription& description);
  SourceLight ReadKind(ParameterReader& reader, const Transform& render_from_light);
  Result<void> AddSources();
  Result<void> AddAreas();
  Result<LightChooser::Method> ReadMethod() const;
  void Warn(const SourceLocation& where, const std::string& text) { diagnostics_.Warn(where, text); }

  const LightInputs& inputs_;
  Geometry& geometry_;
  Diagnostics& diagnostics_;
  LightTable::Data* data_ = nullptr;
};

struct SourceProfiler {
  float scene_radius;

  template <typename PointLike>
  LightProfile operator()(const PointLike& light) const {
    return light.Profile();
  }
  LightProfile operator()(const DistantLight& light) const { return light.Profile(scene_radius); }
  LightProfile operator()(const ImageInfiniteLight& light) const { return light.Profile(scene_radius); }
  LightProfile operator()(const ConstantInfiniteLight&) const { return {false, 0, std::nullopt, 0}; }
};

SourceLight LightBuilder::ReadKind(ParameterReader& reader, const Transform& render_from_light) {
  const std::string& kind = reader.entity().kind;
  if (kind == "point") return PointLight::Read(reader, render_from_light, inputs_.files);
  if (kind == "spot") return SpotLight::Read(reader, render_from_light, inputs_.files);
  if (kind == "distant") return DistantLight::Read(reader, render_from_light, inputs_.files);
  if (kind == "goniometric") {
    return GoniometricLight::Read(reader, render_from_light, inputs_.files, inputs_.images);
  }
  if (kind == "projection") return ProjectionLight::Read(reader, render_from_light, inputs_.images);
  if (kind == "infinite") {
    if (reader.Has("portal")) reader.FailAt("portal", "portals of infinite lights are not supported yet");
    const bool has_picture = !reader.String("filename", "").empty();
    if (!has_picture) return ConstantInfiniteLight::Read(reader, inputs_.files);
    if (reader.Has("L")) reader.FailAt("L", "an infinite light has either \"L\" or \"filename\"");
    return ImageInfiniteLight::Read(reader, render_from_light, inputs_.images);
  }
  reader.Fail("unknown light \"" + kind + "\"" + DidYouMean(kind, kLightKinds));
  return PointLight();
}

Result<SourceLight> LightBuilder::ReadSource(const LightDescription& description) {
  if (description.world_from_light.IsAnimated()) {
    Warn(description.entity.location,
         "lights do not move: its transform at the start of the shutter is used");
  }
  ParameterReader reader(description.entity);
  SourceLight light = ReadKind(reader, inputs_.render_from_world * description.world_from_light.start);
  if (const Result<void> finished = reader.Finish(); !finished) return finished.error();
  return light;
}

Result<void> LightBuilder::AddSources() {
  for (const LightDescription& description : inputs_.scene.lights) {
    Result<SourceLight> light = ReadSource(description);
    if (!light) return light.error();
    const int index = static_cast<int>(data_->sources.size());
    if (std::holds_alternative<ConstantInfiniteLight>(*light) ||
        std::holds_alternative<ImageInfiniteLight>(*light)) {
      data_->infinite.push_back(index);
    }
    data_->sources.push_back(std::move(*light));
  }
  return {};
}

Result<void> LightBuilder::AddAreas() {
  TESSERA_CHECK(inputs_.shape_sources.size() == geometry_.shapes.size());
  for (size_t i = 0; i < geometry_.shapes.size(); ++i) {
    const std::optional<Entity>& entity = inputs_.shape_sources[i]->area_light;
    Shape& shape = geometry_.shapes[i];
    if (!entity) continue;
    if (shape.surface.is_interface) {
      Warn(entity->location, "the area light of a shape with an \"interface\" material is ignored");
      continue;
    }
    const size_t first = data_->sources.size() + data_->areas.size();
    if (first + shape.PrimitiveCount() > kLightsMax) return ErrorAt(entity->location, "too many area lights");
    if (const Result<void> added = data_->areas.Add(*entity, shape, inputs_.files, inputs_.images); !added) {
      return added.error();
    }
    shape.surface.area_light = static_cast<int>(first);
  }
  return {};
}

Result<LightChooser::Method> LightBuilder::ReadMethod() const {
  if (inputs_.light_sampler == "uniform") return LightChooser::Method::kUniform;
  if (inputs_.light_sampler == "power") return LightChooser::Method::kPower;
  if (inputs_.light_sampler == "bvh") return LightChooser::Method::kTree;
  const std::string name(inputs_.light_sampler);
  const SourceLocation& where = inputs_.scene.integrator.location;
  if (name == "exhaustive") return ErrorAt(where, "light sampler \"exhaustive\" is not supported yet");
  return ErrorAt(where, "unknown light sampler \"" + name + "\"" + DidYouMean(name, kLightSamplers));
}

Result<void> LightBuilder::Build(LightTable::Data& data) {
  data_ = &data;
  const Result<LightChooser::Method> method = ReadMethod();
  if (!method) return method.error();
  if (const Result<void> added = AddSources(); !added) return added.error();
  if (const Result<void> added = AddAreas(); !added) return added.error();
  data.textures = &inputs_.textures;
  const Bounds3 bounds = geometry_.Bounds();
  data.scene_radius = bounds.empty() ? 0 : Length(bounds.Diagonal()) / 2;
  std::vector<LightProfile> profiles;
  for (const SourceLight& source : data.sources) {
    profiles.push_back(std::visit(SourceProfiler{data.scene_radius}, source));
  }
  data.areas.AddProfiles(&profiles);
  data.chooser = LightChooser(*method, profiles);
  return {};
}

}  // namespace

Result<LightTable> LightTable::Build(const LightInputs& inputs, Geometry& geometry,
                                     Diagnostics& diagnostics) {
  LightTable table;
  LightBuilder builder(inputs, geometry, diagnostics);
  if (const Result<void> built = builder.Build(*table.data_); !built) return built.error();
  return table;
}

}  // namespace tessera
