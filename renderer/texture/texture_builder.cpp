#include "renderer/texture/texture_builder.h"

#include <array>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "renderer/description/parameter_reader.h"
#include "renderer/texture/texture_assembly.h"
#include "renderer/texture/texture_kinds.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr int kUseCount = 3;

template <typename Map>
std::vector<std::string_view> NamesOf(const Map& map) {
  std::vector<std::string_view> names;
  names.reserve(map.size());
  for (const auto& [name, value] : map) names.push_back(name);
  return names;
}

}  // namespace

struct TextureBuilder::State {
  // A spectrum texture, with the nodes made for each use so far.
  struct SpectrumTexture {
    TextureDescription description;
    std::array<std::optional<SpectrumInput>, kUseCount> variants;
  };

  Transform render_from_world;
  TextureAssembly assembly;
  std::map<std::string, FloatInput, std::less<>> floats;
  std::map<std::string, SpectrumTexture, std::less<>> spectra;

  // The message for a texture of the other type, or for an unknown one.
  template <typename Wanted, typename Other>
  static std::string Unknown(const std::string& name, const Wanted& wanted, std::string_view wanted_type,
                             const Other& other, std::string_view other_type) {
    if (other.contains(name)) {
      return fmt::format("texture {} is a {} texture, expected a {} texture", Quoted(name), other_type,
                         wanted_type);
    }
    return fmt::format("unknown {} texture {}{}", wanted_type, Quoted(name),
                       DidYouMean(name, NamesOf(wanted)));
  }

  Result<FloatInput> MakeFloat(TextureBuilder& builder, const TextureDescription& description) {
    ParameterReader reader(description.entity);
    TextureKindContext context{builder, assembly, reader, render_from_world * description.world_from_texture};
    const FloatInput input = MakeFloatTexture(context);
    if (const Result<void> read = reader.Finish(); !read) return read.error();
    return input;
  }

  // Makes the nodes of one use, unless that was done before. The recursion ends because a texture refers only
  // to textures that were added before it.
  Result<SpectrumInput> Variant(TextureBuilder& builder, SpectrumTexture& texture, SpectrumUse use) {
    std::optional<SpectrumInput>& variant = texture.variants[static_cast<int>(use)];
    if (variant) return *variant;
    const TextureDescription& description = texture.description;
    ParameterReader reader(description.entity);
    TextureKindContext context{builder, assembly, reader, render_from_world * description.world_from_texture};
    const SpectrumInput input = MakeSpectrumTexture(context, use);
    if (const Result<void> read = reader.Finish(); !read) return read.error();
    variant = input;
    return input;
  }

  Result<void> Add(TextureBuilder& builder, const TextureDescription& description) {
    const bool is_known =
        description.is_spectrum ? spectra.contains(description.name) : floats.contains(description.name);
    if (is_known) {
      return ErrorAt(description.entity.location,
                     fmt::format("{} texture {} is defined twice",
                                 description.is_spectrum ? "spectrum" : "float", Quoted(description.name)));
    }
    if (!description.is_spectrum) {
      const Result<FloatInput> input = MakeFloat(builder, description);
      if (!input) return input.error();
      floats.emplace(description.name, *input);
      return {};
    }
    // The least restricted use is made now to find errors, the others when they are needed.
    SpectrumTexture texture{description, {}};
    const Result<SpectrumInput> input = Variant(builder, texture, SpectrumUse::kUnbounded);
    if (!input) return input.error();
    spectra.emplace(description.name, std::move(texture));
    return {};
  }
};

TextureBuilder::TextureBuilder(FileSource& files, ImageCache& images, Diagnostics& diagnostics,
                               const Transform& render_from_world)
    : files_(files), images_(images), diagnostics_(diagnostics), state_(std::make_unique<State>()) {
  state_->render_from_world = render_from_world;
}

TextureBuilder::~TextureBuilder() = default;

Result<void> TextureBuilder::Add(const SceneDescription& scene) {
  for (const TextureDescription& description : scene.textures) {
    if (const Result<void> added = state_->Add(*this, description); !added) return added.error();
  }
  return {};
}

std::optional<FloatInput> TextureBuilder::FindFloat(ParameterReader& reader, std::string_view name) {
  const std::optional<std::string> texture = reader.FindTexture(name);
  if (!texture) {
    const std::optional<float> constant = reader.FindFloat(name);
    return constant ? std::optional<FloatInput>({*constant, -1}) : std::nullopt;
  }
  if (const auto found = state_->floats.find(*texture); found != state_->floats.end()) return found->second;
  reader.FailAt(name, State::Unknown(*texture, state_->floats, "float", state_->spectra, "spectrum"));
  return FloatInput{};
}

FloatInput TextureBuilder::Float(ParameterReader& reader, std::string_view name, float default_value) {
  return FindFloat(reader, name).value_or(FloatInput{default_value, -1});
}

std::optional<SpectrumInput> TextureBuilder::FindSpectrum(ParameterReader& reader, std::string_view name,
                                                          SpectrumUse use) {
  const std::optional<std::string> texture = reader.FindTexture(name);
  if (!texture) {
    const std::optional<Spectrum> constant = FindSpectrumParameter(reader, name, use, files_);
    return constant ? std::optional<SpectrumInput>({*constant, -1}) : std::nullopt;
  }
  const auto found = state_->spectra.find(*texture);
  if (found == state_->spectra.end()) {
    reader.FailAt(name, State::Unknown(*texture, state_->spectra, "spectrum", state_->floats, "float"));
    return SpectrumInput{};
  }
  const Result<SpectrumInput> variant = state_->Variant(*this, found->second, use);
  if (variant) return *variant;
  reader.Fail(variant.error());
  return SpectrumInput{};
}

SpectrumInput TextureBuilder::SpectrumOf(ParameterReader& reader, std::string_view name, SpectrumUse use,
                                         const Spectrum& default_value) {
  return FindSpectrum(reader, name, use).value_or(SpectrumInput{default_value, -1});
}

TextureTable TextureBuilder::Snapshot() const {
  return TextureTable(state_->assembly.nodes());
}

TextureTable TextureBuilder::Finish() {
  TextureTable table(state_->assembly.Take());
  state_ = std::make_unique<State>();
  return table;
}

}  // namespace tessera
