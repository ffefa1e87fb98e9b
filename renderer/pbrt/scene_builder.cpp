#include "renderer/pbrt/scene_builder.h"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "renderer/util/file.h"
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

SceneBuilder::SceneBuilder(FileSource& files, const std::string& name) : files_(&files) {
  top_.file = std::make_shared<const std::string>(name);
  scene_.camera = DefaultEntity("Camera", "perspective", top_);
  scene_.film = DefaultEntity("Film", "rgb", top_);
  scene_.filter = DefaultEntity("PixelFilter", "gaussian", top_);
  scene_.sampler = DefaultEntity("Sampler", "zsobol", top_);
  scene_.integrator = DefaultEntity("Integrator", "volpath", top_);
  scene_.accelerator = DefaultEntity("Accelerator", "bvh", top_);
  scene_.materials.push_back({"", DefaultEntity("Material", "diffuse", top_)});
}

bool SceneBuilder::Fail(const SourceLocation& where, const std::string& message) {
  return scene_.diagnostics.Fail(where, message);
}

void SceneBuilder::Warn(const SourceLocation& where, const std::string& message) {
  scene_.diagnostics.Warn(where, message);
}

void SceneBuilder::WarnOnce(const std::string& topic, const SourceLocation& where,
                            const std::string& message) {
  scene_.diagnostics.WarnOnce(topic, where, message);
}

std::unique_ptr<Lexer> SceneBuilder::Open(const SourceLocation& where, const std::string& statement,
                                          const std::string& name) {
  if (++files_opened_ > kFilesOpenedMax) {
    Fail(where, fmt::format("{} opens more than {} files", statement, kFilesOpenedMax));
    return nullptr;
  }
  Result<std::string> text = files_->Read(name);
  if (text && name.ends_with(".gz")) text = Gunzip(*text, name, kSceneFileSizeMax);
  if (!text) {
    Error error{text.error().kind, OneLine(text.error().message)};
    if (!statement.empty()) {
      error.message =
          ErrorAt(where, fmt::format("{} {}: {}", statement, Quoted(name), text.error().message)).message;
    }
    scene_.diagnostics.Fail(std::move(error));
    return nullptr;
  }
  text_size_ += text->size();
  if (text_size_ > kSceneTextSizeMax) {
    Fail(where, fmt::format("the scene's files hold more than {} bytes of text together", kSceneTextSizeMax));
    return nullptr;
  }
  return OpenText(name, *std::move(text));
}

std::unique_ptr<Lexer> SceneBuilder::OpenText(const std::string& name, std::string text) {
  auto file = *top_.file == name ? top_.file : std::make_shared<const std::string>(name);
  return std::make_unique<Lexer>(std::move(text), std::move(file));
}

bool SceneBuilder::Charge(const SourceLocation& where, uint64_t size) {
  description_size_ += size;
  if (description_size_ <= kDescriptionSizeMax) return true;
  return Fail(where, fmt::format("the scene describes more than {} bytes of data", kDescriptionSizeMax));
}

bool SceneBuilder::Charge(const Entity& entity) {
  return Charge(entity.location, SizeOf(entity));
}

bool SceneBuilder::ChargeCopy(const SourceLocation& where, uint64_t size) {
  copied_size_ += size;
  if (copied_size_ <= kCopiedSizeMax) return Charge(where, size);
  return Fail(where,
              fmt::format("defaults and area lights of shapes hold more than {} bytes", kCopiedSizeMax));
}

bool SceneBuilder::DefineMaterial(MaterialDescription material) {
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

bool SceneBuilder::DefineMedium(MediumDescription medium) {
  const auto [defined, is_new] = media_.try_emplace(medium.name, medium.entity.location);
  if (!is_new) {
    return Fail(medium.entity.location, fmt::format("medium {} is defined twice, first at {}",
                                                    Quoted(medium.name), defined->second.Text()));
  }
  scene_.media.push_back(std::move(medium));
  return true;
}

bool SceneBuilder::DefineTexture(TextureDescription texture) {
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

bool SceneBuilder::DefineObject(ObjectDescription object) {
  const auto [defined, is_new] = objects_.try_emplace(object.name, object.location);
  if (!is_new) {
    return Fail(object.location, fmt::format("object {} is defined twice, first at {}", Quoted(object.name),
                                             defined->second.Text()));
  }
  scene_.objects.push_back(std::move(object));
  return true;
}

bool SceneBuilder::ResolveMaterial(ShapeDescription& shape) {
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

bool SceneBuilder::CheckMedium(const SourceLocation& where, const std::string& name) {
  if (name.empty() || media_.contains(name)) return true;
  return Fail(where, fmt::format("medium {} is not defined{}", Quoted(name), Suggestion(name, media_)));
}

bool SceneBuilder::FinishShape(ShapeDescription& shape) {
  if (!ResolveMaterial(shape)) return false;
  const std::string& material = scene_.materials[shape.material.index].entity.kind;
  if (shape.area_light && (material == "interface" || material == "none" || material.empty())) {
    Warn(shape.entity.location, "the area light is ignored: the shape's material is \"interface\"");
    shape.area_light.reset();
  }
  return CheckMedium(shape.entity.location, shape.inside_medium) &&
         CheckMedium(shape.entity.location, shape.outside_medium);
}

bool SceneBuilder::CheckInstances() {
  for (const InstanceDescription& instance : scene_.instances) {
    if (objects_.contains(instance.name)) continue;
    return Fail(instance.location,
                fmt::format("object {} is not defined, expected the name of an ObjectBegin{}",
                            Quoted(instance.name), Suggestion(instance.name, objects_)));
  }
  return true;
}

bool SceneBuilder::Finish() {
  if (!CheckMedium(scene_.camera.location, scene_.camera_medium)) return false;
  for (const LightDescription& light : scene_.lights) {
    if (!CheckMedium(light.entity.location, light.outside_medium)) return false;
  }
  for (ShapeDescription& shape : scene_.shapes) {
    if (!FinishShape(shape)) return false;
  }
  for (ObjectDescription& object : scene_.objects) {
    for (ShapeDescription& shape : object.shapes) {
      if (!FinishShape(shape)) return false;
    }
  }
  return CheckInstances();
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
