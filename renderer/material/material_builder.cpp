#include "renderer/material/material_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "renderer/color/named_spectra.h"
#include "renderer/util/hash.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 9> kSupported = {
    "conductor", "coateddiffuse", "dielectric", "diffuse",       "diffusetransmission",
    "interface", "mix",           "none",       "thindielectric"};
constexpr std::array<std::string_view, 4> kNotSupportedYet = {"coatedconductor", "hair", "measured",
                                                              "subsurface"};

bool Contains(std::span<const std::string_view> words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool IsInterfaceKind(std::string_view kind) {
  return kind == "interface" || kind.empty() || kind == "none";
}

std::string UnknownKind(const std::string& kind) {
  if (Contains(kNotSupportedYet, kind)) return fmt::format("material \"{}\" is not supported yet", kind);
  std::vector<std::string_view> known(kSupported.begin(), kSupported.end());
  known.insert(known.end(), kNotSupportedYet.begin(), kNotSupportedYet.end());
  return fmt::format("unknown material \"{}\"{}", kind, DidYouMean(kind, known));
}

Spectrum NamedMetal(std::string_view name) {
  return Spectrum::Table(NamedSpectrum(name));
}

uint64_t HashName(const std::string& name, uint64_t hash) {
  for (const char c : name) hash = Hash(hash, static_cast<unsigned char>(c));
  return Hash(hash, name.size());
}

}  // namespace

Result<Material> MaterialBuilder::Build(int index) {
  const MaterialDescription& description = scene_.materials[index];
  ParameterReader reader(description.entity);
  const std::string& kind = description.entity.kind;
  if (IsInterfaceKind(kind)) {
    reader.IgnoreRest();
    return Material{};
  }
  Result<Material> material = BuildKind(kind, index, reader);
  if (!material) return material;
  if (kind != "mix") ReadRelief(reader, *material);
  const Result<void> finished = reader.Finish();
  if (!finished) return finished.error();
  return material;
}

Result<Material> MaterialBuilder::BuildKind(const std::string& kind, int index, ParameterReader& reader) {
  Material material;
  if (kind == "diffuse") {
    material.kind = Diffuse(reader);
  } else if (kind == "diffusetransmission") {
    material.kind = DiffuseTransmission(reader);
  } else if (kind == "conductor") {
    material.kind = Conductor(reader);
  } else if (kind == "dielectric") {
    material.kind = DielectricMaterial{Eta(reader), Roughness(reader)};
  } else if (kind == "thindielectric") {
    material.kind = ThinDielectricMaterial{Eta(reader)};
  } else if (kind == "coateddiffuse") {
    material.kind = CoatedDiffuse(reader);
  } else if (kind == "mix") {
    material.kind = Mix(index, reader);
  } else {
    return ErrorAt(reader.entity().location, UnknownKind(kind));
  }
  return material;
}

DiffuseMaterial MaterialBuilder::Diffuse(ParameterReader& reader) {
  return {textures_.SpectrumOf(reader, "reflectance", SpectrumUse::kAlbedo, Spectrum::Constant(0.5f))};
}

DiffuseTransmissionMaterial MaterialBuilder::DiffuseTransmission(ParameterReader& reader) {
  DiffuseTransmissionMaterial material;
  const Spectrum otherwise = Spectrum::Constant(0.25f);
  material.reflectance = textures_.SpectrumOf(reader, "reflectance", SpectrumUse::kAlbedo, otherwise);
  material.transmittance = textures_.SpectrumOf(reader, "transmittance", SpectrumUse::kAlbedo, otherwise);
  material.scale = reader.Float("scale", 1);
  return material;
}

ConductorMaterial MaterialBuilder::Conductor(ParameterReader& reader) {
  ConductorMaterial material;
  const auto eta = textures_.FindSpectrum(reader, "eta", SpectrumUse::kUnbounded);
  const auto k = textures_.FindSpectrum(reader, "k", SpectrumUse::kUnbounded);
  const auto reflectance = textures_.FindSpectrum(reader, "reflectance", SpectrumUse::kAlbedo);
  if (reflectance && (eta || k)) {
    reader.FailAt("reflectance", "a conductor has either \"reflectance\" or \"eta\" and \"k\", not both");
  }
  if (reflectance) {
    material.has_reflectance = true;
    material.eta = *reflectance;
  } else {
    material.eta = eta ? *eta : SpectrumInput{NamedMetal("metal-Cu-eta"), -1};
    material.k = k ? *k : SpectrumInput{NamedMetal("metal-Cu-k"), -1};
  }
  material.roughness = Roughness(reader);
  return material;
}

CoatedDiffuseMaterial MaterialBuilder::CoatedDiffuse(ParameterReader& reader) {
  CoatedDiffuseMaterial material;
  material.reflectance =
      textures_.SpectrumOf(reader, "reflectance", SpectrumUse::kAlbedo, Spectrum::Constant(0.5f));
  material.albedo = textures_.SpectrumOf(reader, "albedo", SpectrumUse::kAlbedo, Spectrum::Constant(0));
  material.roughness = Roughness(reader);
  material.eta = Eta(reader);
  material.thickness = textures_.Float(reader, "thickness", 0.01f);
  material.thickness.constant = std::max(material.thickness.constant, std::numeric_limits<float>::min());
  material.g = textures_.Float(reader, "g", 0);
  material.depth_max = reader.Integer("maxdepth", 10);
  if (material.depth_max < 0 || material.depth_max > kLayerDepthMax) {
    reader.FailAt("maxdepth", fmt::format("\"maxdepth\" of a coat must be from 0 to {}", kLayerDepthMax));
  }
  material.sample_count = reader.Integer("nsamples", 1);
  if (material.sample_count < 1 || material.sample_count > kLayerSamplesMax) {
    reader.FailAt("nsamples", fmt::format("\"nsamples\" of a coat must be from 1 to {}", kLayerSamplesMax));
  }
  if (!reader.failed()) material.Prepare(coats_);
  return material;
}

int MaterialBuilder::MixElement(const std::string& name, int index, ParameterReader& reader) {
  const auto found = scene_.named_materials.find(name);
  if (found == scene_.named_materials.end()) {
    std::vector<std::string_view> known;
    for (const auto& named : scene_.named_materials) known.push_back(named.first);
    reader.FailAt("materials",
                  fmt::format("material \"{}\" is not defined{}", name, DidYouMean(name, known)));
    return 0;
  }
  const MaterialDescription& element = scene_.materials[found->second];
  if (!scene_.materials[index].name.empty() && found->second >= index) {
    reader.FailAt("materials", fmt::format("material \"{}\" must be defined before it is mixed", name));
  }
  if (IsInterfaceKind(element.entity.kind)) {
    reader.FailAt("materials", fmt::format("material \"{}\" is an interface, which cannot be mixed", name));
  }
  return found->second;
}

MixMaterial MaterialBuilder::Mix(int index, ParameterReader& reader) {
  MixMaterial mix;
  const std::vector<std::string> names = reader.Strings("materials");
  if (names.size() != 2) {
    reader.FailAt("materials", fmt::format("\"materials\" of a mix needs 2 names, not {}", names.size()));
    return mix;
  }
  mix.first = MixElement(names[0], index, reader);
  mix.second = MixElement(names[1], index, reader);
  mix.names_hash = HashName(names[1], HashName(names[0], 0));
  mix.amount = textures_.Float(reader, "amount", 0.5f);
  return mix;
}

RoughnessInput MaterialBuilder::Roughness(ParameterReader& reader) {
  RoughnessInput roughness;
  const auto u = textures_.FindFloat(reader, "uroughness");
  const auto v = textures_.FindFloat(reader, "vroughness");
  roughness.u = u ? *u : textures_.Float(reader, "roughness", 0);
  roughness.v = v ? *v : u ? textures_.Float(reader, "roughness", 0) : roughness.u;
  roughness.remap = reader.Bool("remaproughness", true);
  roughness.Prepare();
  return roughness;
}

EtaInput MaterialBuilder::Eta(ParameterReader& reader) {
  if (const std::optional<float> eta = reader.FindFloat("eta")) {
    if (!(*eta >= 0 && *eta <= kEtaMax)) {
      reader.FailAt("eta", fmt::format("\"eta\" must be from 0 to {}", kEtaMax));
      return {};
    }
    return EtaInput::From(Spectrum::Constant(*eta));
  }
  return EtaInput::From(
      SpectrumParameter(reader, "eta", SpectrumUse::kUnbounded, Spectrum::Constant(1.5f), textures_.files()));
}

void MaterialBuilder::ReadRelief(ParameterReader& reader, Material& material) {
  material.displacement = textures_.FindFloat(reader, "displacement");
  const bool flat =
      material.displacement && material.displacement->IsConstant() && material.displacement->constant == 0;
  if (flat) material.displacement.reset();
  const std::optional<std::string> name = reader.FindString("normalmap");
  if (!name) return;
  const auto image = textures_.images().Get(*name, ColorEncoding{});
  if (!image) return reader.FailAt("normalmap", image.error().message);
  const auto channels = (*image)->RgbChannels();
  if (!channels) {
    return reader.FailAt("normalmap", fmt::format("normal map \"{}\" needs the channels R, G and B", *name));
  }
  material.normal_map = std::make_shared<const NormalMap>(*image, *channels);
}

}  // namespace tessera
