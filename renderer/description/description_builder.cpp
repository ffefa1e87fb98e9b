#include "renderer/description/description_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "renderer/util/text.h"

namespace tessera {
namespace {

Entity DefaultEntity(const char* directive, const char* kind, const SourceLocation& where) {
  return {directive, kind, where, {}};
}

constexpr size_t kCandidatesMax = 10000;  // names compared for a suggestion: the comparison is slow
constexpr size_t kCandidateLengthMax = 100;

template <typename Value>
std::string Suggestion(const std::string& name, const std::map<std::string, Value>& defined) {
  std::vector<std::string_view> names;
  for (const auto& [defined_name, value] : defined) {
    if (names.size() == kCandidatesMax) break;
    if (defined_name.size() <= kCandidateLengthMax) names.push_back(defined_name);
  }
  return DidYouMean(name, names);
}

}  // namespace

DescriptionBuilder::DescriptionBuilder(const std::string& name) {
  top_.file = std::make_shared<const std::string>(name);
  scene_.camera = DefaultEntity("Camera", "perspective", top_);
  scene_.film = DefaultEntity("Film", "rgb", top_);
  scene_.filter = DefaultEntity("PixelFilter", "gaussian", top_);
  scene_.sampler = DefaultEntity("Sampler", "zsobol", top_);
  scene_.integrator = DefaultEntity("Integrator", "volpath", top_);
  scene_.accelerator = DefaultEntity("Accelerator", "bvh", top_);
  scene_.materials.push_back({"", DefaultEntity("Material", "diffuse", top_)});
}

bool DescriptionBuilder::Fail(const SourceLocation& where, const std::string& message) {
  return scene_.diagnostics.Fail(where, message);
}

bool DescriptionBuilder::Charge(const SourceLocation& where, uint64_t size) {
  description_size_ += size;
  // What is not read from text counts no files.
  const uint64_t for_files =
      std::clamp(files_size_ * kDescriptionExpansionMax, kDescriptionFloor, kDescriptionSizeMax);
  const uint64_t allowed = files_size_ == 0 ? kDescriptionSizeMax : for_files;
  if (description_size_ <= allowed) return true;
  const std::string limit =
      files_size_ == 0 ? std::string() : fmt::format(", the limit for files of {} bytes", files_size_);
  return Fail(where, fmt::format("the scene describes more than {} bytes of data{}", allowed, limit));
}

bool DescriptionBuilder::Charge(const Entity& entity) {
  return Charge(entity.location, SizeOf(entity));
}

bool DescriptionBuilder::ChargeCopy(const SourceLocation& where, uint64_t size) {
  copied_size_ += size;
  if (copied_size_ <= kCopiedSizeMax) return Charge(where, size);
  return Fail(where, fmt::format("copied defaults hold more than {} bytes", kCopiedSizeMax));
}

bool DescriptionBuilder::AddMaterial(MaterialDescription material) {
  const int index = static_cast<int>(scene_.materials.size());
  if (!material.name.empty()) {
    const auto [defined, is_new] = scene_.named_materials.try_emplace(material.name, index);
    if (!is_new) {
      return Fail(material.entity.location,
                  fmt::format("material {} is defined twice, first at {}", Quoted(material.name),
                              scene_.materials[defined->second].entity.location.Text()));
    }
  }
  scene_.materials.push_back(std::move(material));
  return true;
}

bool DescriptionBuilder::AddMedium(MediumDescription medium) {
  const auto [defined, is_new] = media_.try_emplace(medium.name, medium.entity.location);
  if (!is_new) {
    return Fail(medium.entity.location, fmt::format("medium {} is defined twice, first at {}",
                                                    Quoted(medium.name), defined->second.Text()));
  }
  scene_.media.push_back(std::move(medium));
  return true;
}

bool DescriptionBuilder::AddTexture(TextureDescription texture) {
  const auto [defined, is_new] =
      textures_.try_emplace({texture.is_spectrum, texture.name}, texture.entity.location);
  if (!is_new) {
    return Fail(texture.entity.location, fmt::format("{} texture {} is defined twice, first at {}",
                                                     texture.is_spectrum ? "spectrum" : "float",
                                                     Quoted(texture.name), defined->second.Text()));
  }
  scene_.textures.push_back(std::move(texture));
  return true;
}

bool DescriptionBuilder::AddObject(ObjectDescription object) {
  if (!Charge(object.location, sizeof object + object.name.size())) return false;
  const auto [defined, is_new] = objects_.try_emplace(object.name, object.location);
  if (!is_new) {
    return Fail(object.location, fmt::format("object {} is defined twice, first at {}", Quoted(object.name),
                                             defined->second.Text()));
  }
  scene_.objects.push_back(std::move(object));
  return true;
}

bool DescriptionBuilder::AddLight(LightDescription light) {
  if (!Charge(light.entity.location,
              sizeof light + light.outside_medium.size() + light.world_from_light.bytes()))
    return false;
  scene_.lights.push_back(std::move(light));
  return true;
}

bool DescriptionBuilder::AddInstance(InstanceDescription instance) {
  if (!Charge(instance.location, sizeof instance + instance.world_from_object.bytes())) return false;
  scene_.instances.push_back(std::move(instance));
  return true;
}

bool DescriptionBuilder::AddShape(ShapeDescription shape, std::optional<size_t> object) {
  const SourceLocation& where = shape.entity.location;
  if (object && shape.area_light) {
    diagnostics().Warn(where, "the area light is ignored: shapes in object definitions cannot emit");
    shape.area_light = nullptr;
  }
  const uint64_t names =
      shape.material.name.size() + shape.inside_medium.size() + shape.outside_medium.size();
  if (!Charge(where, sizeof shape + names + shape.world_from_object.bytes())) return false;
  (object ? scene_.objects[*object].shapes : scene_.shapes).push_back(std::move(shape));
  return true;
}

bool DescriptionBuilder::ResolveMaterial(ShapeDescription& shape) {
  if (shape.material.name.empty()) return true;
  const auto found = scene_.named_materials.find(shape.material.name);
  if (found == scene_.named_materials.end()) {
    return Fail(shape.entity.location,
                fmt::format("material {} is not defined{}", Quoted(shape.material.name),
                            Suggestion(shape.material.name, scene_.named_materials)));
  }
  shape.material.index = found->second;
  return true;
}

bool DescriptionBuilder::CheckMedium(const SourceLocation& where, const std::string& name) {
  if (name.empty() || media_.contains(name)) return true;
  return Fail(where, fmt::format("medium {} is not defined{}", Quoted(name), Suggestion(name, media_)));
}

bool DescriptionBuilder::CheckInstances() {
  for (const InstanceDescription& instance : scene_.instances) {
    if (objects_.contains(instance.name)) continue;
    return Fail(instance.location,
                fmt::format("object {} is not defined, expected the name of an ObjectBegin{}",
                            Quoted(instance.name), Suggestion(instance.name, objects_)));
  }
  return true;
}

bool DescriptionBuilder::FinishShapes(std::vector<ShapeDescription>& shapes) {
  for (ShapeDescription& shape : shapes) {
    const SourceLocation& where = shape.entity.location;
    if (!ResolveMaterial(shape) || !CheckMedium(where, shape.inside_medium) ||
        !CheckMedium(where, shape.outside_medium)) {
      return false;
    }
  }
  return true;
}

bool DescriptionBuilder::ResolveNames() {
  if (!CheckMedium(scene_.camera.location, scene_.camera_medium)) return false;
  for (const LightDescription& light : scene_.lights) {
    if (!CheckMedium(light.entity.location, light.outside_medium)) return false;
  }
  if (!FinishShapes(scene_.shapes)) return false;
  for (ObjectDescription& object : scene_.objects) {
    if (!FinishShapes(object.shapes)) return false;
  }
  return CheckInstances();
}

Result<SceneDescription> DescriptionBuilder::Finish() {
  if (!scene_.diagnostics.error()) ResolveNames();
  if (const std::optional<Error>& error = scene_.diagnostics.error()) return *error;
  return std::move(scene_);
}

uint64_t SizeOf(const Entity& entity) {
  return sizeof(Entity) + SizeOf(entity.parameters);
}

uint64_t SizeOf(const Parameter& p) {
  uint64_t size = sizeof(Parameter) + p.name.size() + p.floats.size() * sizeof(float) +
                  p.integers.size() * sizeof(int) + p.bools.size();
  for (const std::string& s : p.strings) size += sizeof(std::string) + s.size();
  return size;
}

uint64_t SizeOf(const std::vector<Parameter>& parameters) {
  uint64_t size = 0;
  for (const Parameter& p : parameters) size += SizeOf(p);
  return size;
}

}  // namespace tessera
