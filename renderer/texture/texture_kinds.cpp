#include "renderer/texture/texture_kinds.h"

#include <array>

#include <fmt/format.h>

#include "renderer/description/kind_table.h"
#include "renderer/texture/image_texture.h"

namespace tessera {
namespace {

constexpr int kOctavesMax = 64;  // the frequency of a 65th would overflow a float

// Read operands as floats, or as spectra of one use.
struct FloatMaker {
  using Input = FloatInput;
  static constexpr bool kIsFloat = true;
  TextureKindContext& context;

  Input Operand(std::string_view name, float default_value) {
    return context.builder.Float(context.reader, name, default_value);
  }
  Input Constant(std::string_view name, float default_value) {
    return {context.reader.Float(name, default_value), -1};
  }
  std::optional<SpectrumUse> ImageUse() const { return std::nullopt; }
  std::optional<Input> Add(const FloatTextureNode& node, std::span<const Input> operands,
                           const FloatInput& amount) {
    return context.assembly.AddFloat(node, operands, amount);
  }
};

struct SpectrumMaker {
  using Input = SpectrumInput;
  static constexpr bool kIsFloat = false;
  TextureKindContext& context;
  SpectrumUse use;

  Input Operand(std::string_view name, float default_value) {
    return context.builder.SpectrumOf(context.reader, name, use, Spectrum::Constant(default_value));
  }
  Input Constant(std::string_view name, float default_value) {
    return {SpectrumParameter(context.reader, name, use, Spectrum::Constant(default_value),
                              context.builder.files()),
            -1};
  }
  std::optional<SpectrumUse> ImageUse() const { return use; }
  std::optional<Input> Add(const SpectrumTextureNode& node, std::span<const Input> operands,
                           const FloatInput& amount) {
    return context.assembly.AddSpectrum(node, operands, amount);
  }
};

template <typename Maker>
typename Maker::Input Checked(Maker& maker, std::optional<typename Maker::Input> input) {
  if (input) return *input;
  maker.context.reader.Fail(
      fmt::format("textures refer to each other too deeply: at most {} within another and {} in all",
                  kTextureDepthMax, kTextureCostMax));
  return {};
}

template <typename Maker, typename Node>
typename Maker::Input Add(Maker& maker, const Node& node,
                          std::span<const typename Maker::Input> operands = {},
                          const FloatInput& amount = {}) {
  return Checked(maker, maker.Add(node, operands, amount));
}

int Mapping2(TextureKindContext& context) {
  return context.assembly.AddMapping(ReadTextureMapping(context.reader, context.render_from_texture.Inverse(),
                                                        context.builder.diagnostics()));
}
int Mapping3(TextureKindContext& context) {
  return context.assembly.AddMapping(SpaceMapping(context.render_from_texture.Inverse()));
}

template <typename Maker>
typename Maker::Input MakeScale(Maker& maker) {
  const auto texture = maker.Operand("tex", 1);
  const FloatInput factor = maker.context.builder.Float(maker.context.reader, "scale", 1);
  return Checked(maker, maker.context.assembly.Scaled(texture, factor));
}

template <typename Maker>
typename Maker::Input MakeMix(Maker& maker) {
  const std::array<typename Maker::Input, 2> operands{maker.Operand("tex1", 0), maker.Operand("tex2", 1)};
  const FloatInput amount = maker.context.builder.Float(maker.context.reader, "amount", 0.5f);
  if (amount.IsConstant() && amount.constant == 0) return operands[0];
  if (amount.IsConstant() && amount.constant == 1) return operands[1];
  if constexpr (Maker::kIsFloat) {
    if (amount.IsConstant() && operands[0].IsConstant() && operands[1].IsConstant()) {
      return {Lerp(amount.constant, operands[0].constant, operands[1].constant), -1};
    }
  }
  return Add(maker, MixTexture{amount}, operands, amount);
}

template <typename Maker>
typename Maker::Input MakeDirectionMix(Maker& maker) {
  const std::array<typename Maker::Input, 2> operands{maker.Operand("tex1", 0), maker.Operand("tex2", 1)};
  const Vec3 direction =
      maker.context.render_from_texture.ToVector(maker.context.reader.Vector3Value("dir", {0, 1, 0}));
  if (IsZero(direction)) maker.context.reader.FailAt("dir", "dir is zero, expected a direction");
  return Add(maker, DirectionMixTexture{Normalize(direction)}, operands);
}

template <typename Maker>
typename Maker::Input MakeBilerp(Maker& maker) {
  const int mapping = Mapping2(maker.context);
  const std::array<typename Maker::Input, 4> corners{maker.Constant("v00", 0), maker.Constant("v01", 1),
                                                     maker.Constant("v10", 0), maker.Constant("v11", 1)};
  return Add(maker, BilerpTexture{mapping}, corners);
}

template <typename Maker>
typename Maker::Input MakeCheckerboard(Maker& maker) {
  const int dimension = maker.context.reader.Integer("dimension", 2);
  if (dimension != 2 && dimension != 3) {
    maker.context.reader.FailAt("dimension", fmt::format("dimension is {}, expected 2 or 3", dimension));
  }
  const std::array<typename Maker::Input, 2> operands{maker.Operand("tex1", 1), maker.Operand("tex2", 0)};
  const bool is_solid = dimension == 3;
  const int mapping = is_solid ? Mapping3(maker.context) : Mapping2(maker.context);
  return Add(maker, CheckerboardTexture{mapping, is_solid}, operands);
}

template <typename Maker>
typename Maker::Input MakeDots(Maker& maker) {
  const int mapping = Mapping2(maker.context);
  // pbrt-v4's renderer paints the dots with "outside" and the rest with "inside". This does the same, so that
  // the pictures agree.
  const std::array<typename Maker::Input, 2> operands{maker.Operand("inside", 1),
                                                      maker.Operand("outside", 0)};
  return Add(maker, DotsTexture{mapping}, operands);
}

NoiseSettings ReadNoise(ParameterReader& reader) {
  NoiseSettings settings;
  settings.octaves = reader.Integer("octaves", settings.octaves);
  settings.roughness = reader.Float("roughness", settings.roughness);
  if (settings.octaves < 0 || settings.octaves > kOctavesMax) {
    reader.FailAt("octaves", fmt::format("octaves is {}, expected 0 to {}", settings.octaves, kOctavesMax));
    settings.octaves = 0;
  }
  return settings;
}

FloatInput MakeFractalNoise(FloatMaker& maker) {
  const int mapping = Mapping3(maker.context);
  return Add(maker, FractalNoiseTexture{mapping, ReadNoise(maker.context.reader)});
}

FloatInput MakeTurbulence(FloatMaker& maker) {
  const int mapping = Mapping3(maker.context);
  return Add(maker, TurbulenceTexture{mapping, ReadNoise(maker.context.reader)});
}

FloatInput MakeWindy(FloatMaker& maker) {
  return Add(maker, WindyTexture{Mapping3(maker.context)});
}

SpectrumInput MakeMarble(SpectrumMaker& maker) {
  const int mapping = Mapping3(maker.context);
  NoiseSettings settings = ReadNoise(maker.context.reader);
  settings.scale = maker.context.reader.Float("scale", settings.scale);
  settings.variation = maker.context.reader.Float("variation", settings.variation);
  return Add(maker, MarbleTexture{mapping, settings});
}

template <typename Maker>
typename Maker::Input MakeConstant(Maker& maker) {
  return maker.Constant("value", 1);
}

template <typename Maker>
typename Maker::Input MakeImage(Maker& maker) {
  const int mapping = Mapping2(maker.context);
  TextureBuilder& builder = maker.context.builder;
  std::optional<ImageTexture> image =
      ReadImageTexture(maker.context.reader, builder.images(), maker.context.assembly, builder.diagnostics(),
                       maker.ImageUse(), builder.averages_images());
  if (!image) return {};
  image->mapping = mapping;
  return Add(maker, *image);
}

template <typename Maker>
using MakeFunction = typename Maker::Input (*)(Maker&);

constexpr Kind<MakeFunction<FloatMaker>> kFloatKinds[] = {
    {"bilerp", Support::kSupported, MakeBilerp},
    {"checkerboard", Support::kSupported, MakeCheckerboard},
    {"constant", Support::kSupported, MakeConstant},
    {"directionmix", Support::kSupported, MakeDirectionMix},
    {"dots", Support::kSupported, MakeDots},
    {"fbm", Support::kSupported, MakeFractalNoise},
    {"imagemap", Support::kSupported, MakeImage},
    {"mix", Support::kSupported, MakeMix},
    {"scale", Support::kSupported, MakeScale},
    {"windy", Support::kSupported, MakeWindy},
    {"wrinkled", Support::kSupported, MakeTurbulence},
    {"ptex", Support::kNotSupported},
};
constexpr KindTable<MakeFunction<FloatMaker>> kFloatTable("float texture", kFloatKinds);

constexpr Kind<MakeFunction<SpectrumMaker>> kSpectrumKinds[] = {
    {"bilerp", Support::kSupported, MakeBilerp},     {"checkerboard", Support::kSupported, MakeCheckerboard},
    {"constant", Support::kSupported, MakeConstant}, {"directionmix", Support::kSupported, MakeDirectionMix},
    {"dots", Support::kSupported, MakeDots},         {"imagemap", Support::kSupported, MakeImage},
    {"marble", Support::kSupported, MakeMarble},     {"mix", Support::kSupported, MakeMix},
    {"scale", Support::kSupported, MakeScale},       {"ptex", Support::kNotSupported},
};
constexpr KindTable<MakeFunction<SpectrumMaker>> kSpectrumTable("spectrum texture", kSpectrumKinds);

template <typename Maker>
typename Maker::Input Make(Maker maker, const KindTable<MakeFunction<Maker>>& table) {
  ParameterReader& reader = maker.context.reader;
  const std::string& name = reader.entity().kind;
  if (const auto* kind = table.Find(name)) return kind->reader(maker);
  reader.Fail(table.Refusal(name));
  return {};
}

}  // namespace

FloatInput MakeFloatTexture(TextureKindContext& context) {
  return Make(FloatMaker{context}, kFloatTable);
}

SpectrumInput MakeSpectrumTexture(TextureKindContext& context, SpectrumUse use) {
  return Make(SpectrumMaker{context, use}, kSpectrumTable);
}

KindList FloatTextureKinds() {
  return kFloatTable.List();
}

KindList SpectrumTextureKinds() {
  return kSpectrumTable.List();
}

}  // namespace tessera
