#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "renderer/pbrt/scene_parser.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 4> kColorSpaces{"srgb", "dci-p3", "rec2020", "aces2065-1"};
constexpr std::array<std::string_view, 2> kTextureTypes{"float", "spectrum"};

}  // namespace

bool SceneParser::Attribute(const Statement& statement) {
  std::string name;
  std::vector<Parameter> parameters;
  if (!ReadName(statement, "target", &name)) return false;
  const auto target = std::find(kAttributeTargets.begin(), kAttributeTargets.end(), name);
  if (target == kAttributeTargets.end()) {
    return builder_->Fail(statement.location, fmt::format("unknown Attribute target {}{}, expected one of {}",
                                                          Quoted(name), DidYouMean(name, kAttributeTargets),
                                                          fmt::join(kAttributeTargets, " ")));
  }
  if (!ReadParameters(&parameters)) return false;
  for (Parameter& parameter : parameters) parameter.from_attribute = true;
  const auto index = static_cast<AttributeTarget>(target - kAttributeTargets.begin());
  const uint64_t size = SizeOf(state_.Attributes(index)) + SizeOf(parameters);
  if (size > kDefaultsSizeMax) {
    return builder_->Fail(
        statement.location,
        fmt::format("the defaults of Attribute {} hold more than {} bytes", Quoted(name), kDefaultsSizeMax));
  }
  if (!builder_->Charge(statement.location, size)) return false;
  state_.AddAttributes(index, std::move(parameters));
  return true;
}

bool SceneParser::ColorSpace(const Statement& statement) {
  std::string name;
  if (!ReadName(statement, "name", &name)) return false;
  std::string lower = name;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (std::find(kColorSpaces.begin(), kColorSpaces.end(), lower) == kColorSpaces.end()) {
    return builder_->Fail(statement.location,
                          fmt::format("unknown colour space {}{}, expected one of {}", Quoted(name),
                                      DidYouMean(lower, kColorSpaces), fmt::join(kColorSpaces, " ")));
  }
  state_.color_space = lower;
  return true;
}

bool SceneParser::ReverseOrientation(const Statement&) {
  state_.reverse_orientation = !state_.reverse_orientation;
  return true;
}

bool SceneParser::MediumInterface(const Statement& statement) {
  if (!ReadName(statement, "inside medium", &state_.inside_medium)) return false;
  if (tokens_.Peek().kind == Token::Kind::kString) {
    return ReadName(statement, "outside medium", &state_.outside_medium);
  }
  state_.outside_medium = state_.inside_medium;
  return true;
}

bool SceneParser::MakeNamedMedium(const Statement& statement) {
  MediumDescription medium;
  if (!ReadNamedEntity(statement, AttributeTarget::kMedium, &medium.name, &medium.entity)) return false;
  medium.world_from_medium = state_.transform;
  if (state_.transform.IsAnimated()) {
    builder_->Warn(statement.location,
                   "the medium does not move: the transformation at the start time is used");
  }
  return builder_->DefineMedium(std::move(medium));
}

bool SceneParser::Material(const Statement& statement) {
  MaterialDescription material;
  if (!ReadEntity(statement, AttributeTarget::kMaterial, &material.entity)) return false;
  state_.material = {static_cast<int>(builder_->scene().materials.size()), ""};
  return builder_->DefineMaterial(std::move(material));
}

bool SceneParser::MakeNamedMaterial(const Statement& statement) {
  MaterialDescription material;
  if (!ReadNamedEntity(statement, AttributeTarget::kMaterial, &material.name, &material.entity)) return false;
  if (material.name.empty()) {
    return builder_->Fail(statement.location, "MakeNamedMaterial with an empty name");
  }
  return builder_->DefineMaterial(std::move(material));
}

bool SceneParser::NamedMaterial(const Statement& statement) {
  std::string name;
  if (!ReadName(statement, "name", &name)) return false;
  if (name.empty()) return builder_->Fail(statement.location, "NamedMaterial with an empty name");
  state_.material = {0, name};  // the index follows at the end: the material may be defined later
  return true;
}

bool SceneParser::Texture(const Statement& statement) {
  TextureDescription texture;
  std::string type;
  if (!ReadName(statement, "name", &texture.name)) return false;
  const SourceLocation type_location = tokens_.Peek().Location();
  if (!ReadName(statement, "type, \"float\" or \"spectrum\",", &type)) return false;
  if (std::find(kTextureTypes.begin(), kTextureTypes.end(), type) == kTextureTypes.end()) {
    const std::string hint =
        type == "color" ? " (did you mean \"spectrum\"?)" : DidYouMean(type, kTextureTypes);
    return builder_->Fail(
        type_location,
        fmt::format("unknown texture type {}{}, expected \"float\" or \"spectrum\"", Quoted(type), hint));
  }
  texture.is_spectrum = type == "spectrum";
  if (!ReadEntity(statement, AttributeTarget::kTexture, &texture.entity)) return false;
  texture.world_from_texture = state_.transform;
  if (state_.transform.IsAnimated()) {
    builder_->Warn(statement.location,
                   "the texture does not move: the transformation at the start time is used");
  }
  return builder_->DefineTexture(std::move(texture));
}

bool SceneParser::LightSource(const Statement& statement) {
  LightDescription light;
  if (!ReadEntity(statement, AttributeTarget::kLight, &light.entity)) return false;
  light.world_from_light = state_.transform;
  light.outside_medium = state_.outside_medium;
  if (state_.transform.IsAnimated()) {
    builder_->Warn(statement.location,
                   "the light does not move: the transformation at the start time is used");
  }
  builder_->scene().lights.push_back(std::move(light));
  return builder_->Charge(statement.location, sizeof(LightDescription));
}

bool SceneParser::AreaLightSource(const Statement& statement) {
  Entity light;
  if (!ReadEntity(statement, AttributeTarget::kLight, &light)) return false;
  state_.area_light = light.kind.empty() ? nullptr : std::make_shared<const Entity>(std::move(light));
  return true;
}

bool SceneParser::SetAreaLight(ShapeDescription* shape) {
  const SourceLocation& location = shape->entity.location;
  if (!state_.area_light) return true;
  if (object_) {
    builder_->Warn(location, "the area light is ignored: shapes in object definitions cannot emit");
    return true;
  }
  if (state_.transform.IsAnimated()) {
    return builder_->Fail(location, "a moving shape has an area light, expected one that stands still");
  }
  shape->area_light = *state_.area_light;
  return builder_->ChargeCopy(location, SizeOf(*shape->area_light));
}

bool SceneParser::Shape(const Statement& statement) {
  ShapeDescription shape;
  if (!ReadEntity(statement, AttributeTarget::kShape, &shape.entity)) return false;
  shape.world_from_object = state_.transform;
  shape.reverse_orientation = state_.reverse_orientation;
  shape.material = state_.material;
  shape.inside_medium = state_.inside_medium;
  shape.outside_medium = state_.outside_medium;
  if (!SetAreaLight(&shape)) return false;
  const uint64_t names =
      shape.material.name.size() + shape.inside_medium.size() + shape.outside_medium.size();
  if (!builder_->Charge(statement.location, sizeof shape + names)) return false;
  auto& shapes = object_ ? builder_->scene().objects[*object_].shapes : builder_->scene().shapes;
  shapes.push_back(std::move(shape));
  return true;
}

bool SceneParser::ObjectInstance(const Statement& statement) {
  InstanceDescription instance;
  if (!ReadName(statement, "name", &instance.name)) return false;
  if (object_) {
    return builder_->Fail(
        statement.location,
        fmt::format("ObjectInstance inside the definition of object {}, expected ObjectEnd first",
                    Quoted(builder_->scene().objects[*object_].name)));
  }
  instance.location = statement.location;
  instance.world_from_object = state_.transform;
  builder_->scene().instances.push_back(std::move(instance));
  return builder_->Charge(statement.location, sizeof(InstanceDescription));
}

}  // namespace tessera
