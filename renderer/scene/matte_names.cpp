#include "renderer/scene/matte_names.h"

#include <fmt/format.h>

#include <optional>

#include "renderer/description/parameter_reader.h"
#include "renderer/film/cryptomatte.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

std::string TextOf(ParameterReader& reader, std::string_view name) {
  return MatteName(reader.FindString(name).value_or(""));
}

// What shapes without a name are numbered under: their kind, or the name of their file without its folder and
// endings.
std::string BaseName(ParameterReader& reader) {
  const std::string& kind = reader.entity().kind;
  if (kind != "plymesh") return MatteName(kind);
  std::string file = reader.FindString("filename").value_or("");
  file = file.substr(file.find_last_of('/') + 1);
  const std::string stem = MatteName(file.substr(0, file.find('.')));
  return stem.empty() ? kind : stem;
}

}  // namespace

std::string MatteName(std::string_view name) {
  std::string clean = CleanText(Normalize(name), std::string::npos);
  if (clean.size() <= kMatteNameBytesMax) return clean;
  const std::string hash = fmt::format("#{:08x}", MurmurHash3(clean));
  return CleanText(clean, kMatteNameBytesMax - hash.size()) + hash;
}

int ShapeNamer::Add(const ShapeDescription& shape, bool is_instanced) {
  ParameterReader reader(shape.entity);
  ShapeName name{TextOf(reader, "name"), TextOf(reader, "asset")};
  const bool is_curve = shape.entity.kind == "curve";
  if (name.object.empty() && name.asset.empty()) {
    if (is_instanced) return 0;
    if (is_curve && run_ > 0) return run_;
  }
  const bool starts_run = !is_instanced && is_curve && name.object.empty() && name.asset.empty();
  if (name.object.empty() && !is_instanced) {
    const std::string base = BaseName(reader);
    name.object = fmt::format("{}.{}", base, ++counts_[base]);
  }
  if (name.asset.empty() && !is_instanced) name.asset = name.object;
  const ShapeName& last = names_.back();
  if (names_.size() == 1 || last.object != name.object || last.asset != name.asset)
    names_.push_back(std::move(name));
  const int index = static_cast<int>(names_.size()) - 1;
  run_ = starts_run ? index : 0;
  return index;
}

SceneNames::SceneNames(const SceneDescription& scene) : scene_(scene) {
  for (const ShapeDescription& shape : scene.shapes) index_[&shape] = namer_.Add(shape, false);
  for (const ObjectDescription& object : scene.objects) {
    for (const ShapeDescription& shape : object.shapes) index_[&shape] = namer_.Add(shape, true);
  }
  std::map<std::string_view, uint32_t> counts;
  for (const InstanceDescription& instance : scene.instances) numbers_.push_back(++counts[instance.name]);
}

void SceneNames::NoteInstances(size_t count, int instance) {
  instances_.resize(count, {instance, numbers_[static_cast<size_t>(instance)]});
}

std::vector<std::string> MaterialNames(const SceneDescription& scene) {
  std::map<std::string, uint32_t> counts;
  std::vector<std::string> names;
  for (const MaterialDescription& material : scene.materials) {
    if (names.empty()) {
      names.emplace_back("default");
      continue;
    }
    std::string name = MatteName(material.name);
    if (name.empty()) {
      const std::string kind = MatteName(material.entity.kind);
      name = fmt::format("{}.{}", kind, ++counts[kind]);
    }
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace tessera
