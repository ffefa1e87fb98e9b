#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "renderer/math/flat_transform.h"
#include "renderer/pbrt/scene_parser.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 4> kColorSpaces{"srgb", "dci-p3", "rec2020", "aces2065-1"};
constexpr std::array<std::string_view, 2> kTextureTypes{"float", "spectrum"};

}  // namespace

bool SceneParser::Attribute(const Statement& statement) {
  const std::optional<std::string> name = ReadName(statement, "target");
  if (!name) return false;
  const auto target = std::find(kAttributeTargets.begin(), kAttributeTargets.end(), *name);
  if (target == kAttributeTargets.end()) {
    return Fail(statement.location,
                fmt::format("unknown Attribute target {}{}, expected one of {}", Quoted(*name),
                            DidYouMean(*name, kAttributeTargets), fmt::join(kAttributeTargets, " ")));
  }
  std::optional<std::vector<Parameter>> parameters = ReadParameters();
  if (!parameters) return false;
  for (Parameter& parameter : *parameters) parameter.is_default = true;
  const auto index = static_cast<AttributeTarget>(target - kAttributeTargets.begin());
  const uint64_t size = SizeOf(state_.Attributes(index)) + SizeOf(*parameters);
  if (size > kDefaultsSizeMax) {
    return Fail(statement.location, fmt::format("the defaults of Attribute {} hold more than {} bytes",
                                                Quoted(*name), kDefaultsSizeMax));
  }
  if (!builder_->Charge(statement.location, size)) return false;
  state_.AddAttributes(index, *std::move(parameters));
  return true;
}

bool SceneParser::ColorSpace(const Statement& statement) {
  std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  std::string lower = *name;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (std::find(kColorSpaces.begin(), kColorSpaces.end(), lower) == kColorSpaces.end()) {
    Warn(statement.location,
         fmt::format("unknown colour space {}{}, expected one of {}: the colour space is still {}",
                     Quoted(*name), DidYouMean(lower, kColorSpaces), fmt::join(kColorSpaces, " "),
                     state_.color_space));
    return true;
  }
  state_.color_space = lower;
  return true;
}

bool SceneParser::ReverseOrientation(const Statement&) {
  state_.reverse_orientation = !state_.reverse_orientation;
  return true;
}

bool SceneParser::MediumInterface(const Statement& statement) {
  const std::optional<std::string> inside = ReadName(statement, "inside medium");
  if (!inside) return false;
  const bool has_outside = tokens_.Peek().kind == Token::Kind::kString;
  const std::optional<std::string> outside = has_outside ? ReadName(statement, "outside medium") : inside;
  if (!outside) return false;
  state_.inside_medium = *inside;
  state_.outside_medium = *outside;
  return true;
}

bool SceneParser::MakeNamedMedium(const Statement& statement) {
  std::optional<NamedEntity> medium = ReadNamedEntity(statement, AttributeTarget::kMedium);
  return medium && builder_->AddMedium(
                       {std::move(medium->name), std::move(medium->entity), AtRest(statement, "medium")});
}

bool SceneParser::Material(const Statement& statement) {
  std::optional<Entity> material = ReadEntity(statement, AttributeTarget::kMaterial);
  if (!material) return false;
  state_.material = {static_cast<int>(builder_->scene().materials.size()), ""};
  return builder_->AddMaterial({"", *std::move(material)});
}

bool SceneParser::MakeNamedMaterial(const Statement& statement) {
  std::optional<NamedEntity> material = ReadNamedEntity(statement, AttributeTarget::kMaterial);
  if (!material) return false;
  if (material->name.empty()) return Fail(statement.location, "MakeNamedMaterial with an empty name");
  return builder_->AddMaterial({std::move(material->name), std::move(material->entity)});
}

bool SceneParser::NamedMaterial(const Statement& statement) {
  std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  if (name->empty()) return Fail(statement.location, "NamedMaterial with an empty name");
  state_.material = {0, *std::move(name)};
  return true;
}

bool SceneParser::Texture(const Statement& statement) {
  std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  const SourceLocation type_location = tokens_.Peek().Location();
  const std::optional<std::string> type = ReadName(statement, "type, \"float\" or \"spectrum\",");
  if (!type) return false;
  if (std::find(kTextureTypes.begin(), kTextureTypes.end(), *type) == kTextureTypes.end()) {
    return Fail(type_location, fmt::format("unknown texture type {}{}, expected \"float\" or \"spectrum\"",
                                           Quoted(*type), DidYouMean(*type, kTextureTypes)));
  }
  std::optional<Entity> entity = ReadEntity(statement, AttributeTarget::kTexture);
  return entity && builder_->AddTexture({*std::move(name), *type == "spectrum", *std::move(entity),
                                         AtRest(statement, "texture")});
}

bool SceneParser::LightSource(const Statement& statement) {
  std::optional<Entity> entity = ReadEntity(statement, AttributeTarget::kLight);
  if (entity && IsFlat(state_.transform.start)) {
    Warn(statement.location, "the light is ignored: its transformation has no inverse");
    return true;
  }
  if (!entity) return false;
  // Its picture is resampled once, seen from the portal, which is in world space.
  const bool has_portal = std::ranges::any_of(
      entity->parameters, [](const Parameter& parameter) { return parameter.name == "portal"; });
  AnimatedTransform transform =
      has_portal ? AnimatedTransform(AtRest(statement, "light with a portal")) : Moving();
  return builder_->AddLight({*std::move(entity), std::move(transform), state_.outside_medium});
}

bool SceneParser::AreaLightSource(const Statement& statement) {
  std::optional<Entity> light = ReadEntity(statement, AttributeTarget::kLight);
  if (!light) return false;
  state_.area_light = light->kind.empty() ? nullptr : std::make_shared<const Entity>(*std::move(light));
  return true;
}

bool SceneParser::Shape(const Statement& statement) {
  std::optional<Entity> entity = ReadEntity(statement, AttributeTarget::kShape);
  if (!entity) return false;
  ShapeDescription shape;
  shape.entity = *std::move(entity);
  shape.world_from_object = Moving();
  shape.reverse_orientation = state_.reverse_orientation;
  shape.material = state_.material;
  shape.area_light = state_.area_light;
  shape.inside_medium = state_.inside_medium;
  shape.outside_medium = state_.outside_medium;
  return builder_->AddShape(std::move(shape), object_);
}

bool SceneParser::ObjectInstance(const Statement& statement) {
  std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  if (object_) {
    return Fail(statement.location,
                fmt::format("ObjectInstance inside the definition of object {}, expected ObjectEnd first",
                            Quoted(builder_->scene().objects[*object_].name)));
  }
  return builder_->AddInstance({*std::move(name), statement.location, Moving()});
}

}  // namespace tessera
