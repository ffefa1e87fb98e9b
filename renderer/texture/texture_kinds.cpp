#include "renderer/texture/texture_kinds.h"

#include <array>

#include <fmt/format.h>

#include "renderer/texture/image_texture.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr int kOctavesMax = 64;  // the frequency of the last is then beyond float

// Reads operands as floats, or as spectra of one use.
struct FloatMaker {
  using Input = FloatInput;
  static constexpr bool kIsFloat = true;
  TextureKindContext& context;

  Input Operand(std::string_view name, float otherwise) {
    return context.builder.Float(context.reader, name, otherwise);
  }
  Input Constant(std::string_view name, float otherwise) {
    return {context.reader.Float(name, otherwise), -1};
  }
  Input Image(int mapping) {
    const auto image =
        ReadImageTexture(context.reader, context.builder.images(), context.assembly, std::nullopt);
    return image ? context.assembly.AddFloatImage(*image, mapping) : Input{};
  }
  std::optional<Input> Add(const TextureNode& node, std::span<const Input> operands) {
    return context.assembly.AddFloat(node, operands);
  }
};

struct SpectrumMaker {
  using Input = SpectrumInput;
  static constexpr bool kIsFloat = false;
  TextureKindContext& context;
  SpectrumUse use;

  Input Operand(std::string_view name, float otherwise) {
    return context.builder.SpectrumOf(context.reader, name, use, Spectrum::Constant(otherwise));
  }
  Input Constant(std::string_view name, float otherwise) {
    return {
        SpectrumParameter(context.reader, name, use, Spectrum::Constant(otherwise), context.builder.files()),
        -1};
  }
  Input Image(int mapping) {
    const auto image = ReadImageTexture(context.reader, context.builder.images(), context.assembly, use);
    return image ? context.assembly.AddSpectrumImage(*image, mapping) : Input{};
  }
  std::optional<Input> Add(const TextureNode& node, std::span<const Input> operands) {
    return context.assembly.AddSpectrum(node, operands);
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

template <typename Maker, size_t kCount>
typename Maker::Input Add(Maker& maker, const TextureNode& node,
                          const std::array<typename Maker::Input, kCount>& operands) {
  return Checked(maker, maker.Add(node, operands));
}

int Mapping2(TextureKindContext& context) {
  return context.assembly.AddMapping(
      ReadTextureMapping(context.reader, context.render_from_texture.Inverse()));
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
  TextureNode node;
  node.kind = TextureKind::kMix;
  node.amount = maker.context.builder.Float(maker.context.reader, "amount", 0.5f);
  if (node.amount.IsConstant() && node.amount.constant == 0) return operands[0];
  if (node.amount.IsConstant() && node.amount.constant == 1) return operands[1];
  if constexpr (Maker::kIsFloat) {
    if (node.amount.IsConstant() && operands[0].IsConstant() && operands[1].IsConstant()) {
      return {Lerp(node.amount.constant, operands[0].constant, operands[1].constant), -1};
    }
  }
  return Add(maker, node, operands);
}

template <typename Maker>
typename Maker::Input MakeDirectionMix(Maker& maker) {
  const std::array<typename Maker::Input, 2> operands{maker.Operand("tex1", 0), maker.Operand("tex2", 1)};
  const Vec3 direction =
      maker.context.render_from_texture.ToVector(maker.context.reader.Vector3Value("dir", {0, 1, 0}));
  if (IsZero(direction)) maker.context.reader.FailAt("dir", "dir is zero, expected a direction");
  TextureNode node;
  node.kind = TextureKind::kDirectionMix;
  node.detail = maker.context.assembly.AddDirection(Normalize(direction));
  return Add(maker, node, operands);
}

template <typename Maker>
typename Maker::Input MakeBilerp(Maker& maker) {
  TextureNode node;
  node.kind = TextureKind::kBilerp;
  node.mapping = Mapping2(maker.context);
  const std::array<typename Maker::Input, 4> corners{maker.Constant("v00", 0), maker.Constant("v01", 1),
                                                     maker.Constant("v10", 0), maker.Constant("v11", 1)};
  return Add(maker, node, corners);
}

template <typename Maker>
typename Maker::Input MakeCheckerboard(Maker& maker) {
  const int dimension = maker.context.reader.Integer("dimension", 2);
  if (dimension != 2 && dimension != 3) {
    maker.context.reader.FailAt("dimension", fmt::format("dimension is {}, expected 2 or 3", dimension));
  }
  const std::array<typename Maker::Input, 2> operands{maker.Operand("tex1", 1), maker.Operand("tex2", 0)};
  TextureNode node;
  node.kind = dimension == 3 ? TextureKind::kCheckerboard3 : TextureKind::kCheckerboard2;
  node.mapping = dimension == 3 ? Mapping3(maker.context) : Mapping2(maker.context);
  return Add(maker, node, operands);
}

template <typename Maker>
typename Maker::Input MakeDots(Maker& maker) {
  TextureNode node;
  node.kind = TextureKind::kDots;
  node.mapping = Mapping2(maker.context);
  // pbrt's renderer paints the dots with "outside" and the rest with "inside"; pictures must agree with its.
  const std::array<typename Maker::Input, 2> operands{maker.Operand("inside", 1),
                                                      maker.Operand("outside", 0)};
  return Add(maker, node, operands);
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

FloatInput MakeNoise(FloatMaker& maker, TextureKind kind) {
  TextureNode node;
  node.kind = kind;
  node.mapping = Mapping3(maker.context);
  if (kind != TextureKind::kWindy)
    node.detail = maker.context.assembly.AddNoise(ReadNoise(maker.context.reader));
  return Checked(maker, maker.Add(node, {}));
}

SpectrumInput MakeMarble(SpectrumMaker& maker) {
  TextureNode node;
  node.kind = TextureKind::kMarble;
  node.mapping = Mapping3(maker.context);
  NoiseSettings settings = ReadNoise(maker.context.reader);
  settings.scale = maker.context.reader.Float("scale", settings.scale);
  settings.variation = maker.context.reader.Float("variation", settings.variation);
  node.detail = maker.context.assembly.AddNoise(settings);
  return Checked(maker, maker.Add(node, {}));
}

FloatInput MakeFractalNoise(FloatMaker& maker) {
  return MakeNoise(maker, TextureKind::kFractalNoise);
}
FloatInput MakeWrinkled(FloatMaker& maker) {
  return MakeNoise(maker, TextureKind::kTurbulence);
}
FloatInput MakeWindy(FloatMaker& maker) {
  return MakeNoise(maker, TextureKind::kWindy);
}

template <typename Maker>
typename Maker::Input MakeConstant(Maker& maker) {
  return maker.Constant("value", 1);
}

template <typename Maker>
typename Maker::Input MakeImage(Maker& maker) {
  return maker.Image(Mapping2(maker.context));
}

template <typename Maker>
struct Kind {
  std::string_view name;
  typename Maker::Input (*make)(Maker&);
};

constexpr std::array<Kind<FloatMaker>, 11> kFloatKinds{{
    {"bilerp", MakeBilerp},
    {"checkerboard", MakeCheckerboard},
    {"constant", MakeConstant},
    {"directionmix", MakeDirectionMix},
    {"dots", MakeDots},
    {"fbm", MakeFractalNoise},
    {"imagemap", MakeImage},
    {"mix", MakeMix},
    {"scale", MakeScale},
    {"windy", MakeWindy},
    {"wrinkled", MakeWrinkled},
}};

constexpr std::array<Kind<SpectrumMaker>, 9> kSpectrumKinds{{
    {"bilerp", MakeBilerp},
    {"checkerboard", MakeCheckerboard},
    {"constant", MakeConstant},
    {"directionmix", MakeDirectionMix},
    {"dots", MakeDots},
    {"imagemap", MakeImage},
    {"marble", MakeMarble},
    {"mix", MakeMix},
    {"scale", MakeScale},
}};

template <typename Maker, size_t kCount>
typename Maker::Input Make(Maker maker, const std::array<Kind<Maker>, kCount>& kinds,
                           std::string_view value_type) {
  ParameterReader& reader = maker.context.reader;
  const std::string& kind = reader.entity().kind;
  std::array<std::string_view, kCount> names;
  for (size_t i = 0; i < kCount; ++i) {
    if (kinds[i].name == kind) return kinds[i].make(maker);
    names[i] = kinds[i].name;
  }
  if (kind == "ptex") {
    reader.Fail("texture \"ptex\" is not supported yet");
  } else {
    reader.Fail(fmt::format("unknown {} texture {}{}", value_type, Quoted(kind), DidYouMean(kind, names)));
  }
  return {};
}

}  // namespace

FloatInput MakeFloatTexture(TextureKindContext& context) {
  return Make(FloatMaker{context}, kFloatKinds, "float");
}

SpectrumInput MakeSpectrumTexture(TextureKindContext& context, SpectrumUse use) {
  return Make(SpectrumMaker{context, use}, kSpectrumKinds, "spectrum");
}

}  // namespace tessera
