#include "renderer/material/mix_material.h"

#include <fmt/format.h>

#include "renderer/material/interface_material.h"
#include "renderer/math/random_stream.h"
#include "renderer/text/unicode.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

uint64_t HashName(const std::string& name, uint64_t hash) {
  for (const char c : name) hash = Hash(hash, static_cast<unsigned char>(c));
  return Hash(hash, name.size());
}

// The index of the material of this name that the mix may choose.
int ReadElement(const std::string& name, MaterialReader& reader) {
  const SceneDescription& scene = reader.scene;
  const auto found = scene.named_materials.find(name);
  if (found == scene.named_materials.end()) {
    std::vector<std::string_view> known;
    for (const auto& named : scene.named_materials) known.push_back(named.first);
    reader.parameters.FailAt("materials",
                             fmt::format("material \"{}\" is not defined{}", name, DidYouMean(name, known)));
    return 0;
  }
  const MaterialDescription& element = scene.materials[found->second];
  if (!scene.materials[reader.index].name.empty() && found->second >= reader.index) {
    reader.parameters.FailAt("materials",
                             fmt::format("material \"{}\" must be defined before it is mixed", name));
  }
  if (InterfaceMaterial::IsNamed(element.entity.kind)) {
    reader.parameters.FailAt("materials",
                             fmt::format("material \"{}\" is an interface, which cannot be mixed", name));
  }
  return found->second;
}

}  // namespace

MixMaterial MixMaterial::Read(MaterialReader& reader) {
  MixMaterial mix;
  std::vector<std::string> names = reader.parameters.Strings("materials");
  for (std::string& name : names) name = Normalize(name);
  if (names.size() != 2) {
    reader.parameters.FailAt("materials",
                             fmt::format("\"materials\" of a mix needs 2 names, not {}", names.size()));
    return mix;
  }
  mix.first = ReadElement(names[0], reader);
  mix.second = ReadElement(names[1], reader);
  mix.names_hash = HashName(names[1], HashName(names[0], 0));
  mix.amount = reader.Float("amount", 0.5f);
  return mix;
}

int MixMaterial::Choose(const TextureTable& textures, const TextureContext& context,
                        const SurfaceInteraction& interaction) const {
  const float share = textures.Evaluate(amount, context);
  if (share <= 0) return first;
  if (share >= 1) return second;
  const uint64_t hash = ExtendHash(Hash(names_hash), interaction.p, interaction.wo);
  return share < UniformFloatFromHash(hash) ? first : second;
}

}  // namespace tessera
