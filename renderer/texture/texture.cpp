#include "renderer/texture/texture.h"

#include "renderer/color/color_space.h"
#include "renderer/texture/noise.h"
#include "renderer/texture/texture_node.h"

namespace tessera {
namespace {

// The two kinds of value differ only in how operands and images are read.
struct FloatEvaluation {
  using Value = float;
  const TextureNodes& nodes;
  const TextureContext& context;

  float Operand(const TextureNode& node, int i) const {
    return Float(nodes.float_operands[node.operand + i]);
  }
  float Float(const FloatInput& input) const {
    return input.IsConstant() ? input.constant : EvaluateFloatTexture(nodes, input.texture, context);
  }
  float Image(const ImageTexture& image, const TextureCoordinates2& c) const {
    const float v = image.scale * image.map->LookUpGrey({c.st.x, 1 - c.st.y}, c.dx, c.dy, image.filter);
    return image.invert ? std::max(0.0f, 1 - v) : v;
  }
  float Procedural(const TextureNode& node) const {
    const TextureCoordinates3 c = nodes.mappings[node.mapping].Map3(context);
    if (node.kind == TextureKind::kWindy) return WindyWaves(c);
    const NoiseSettings& settings = nodes.noises[node.detail];
    return node.kind == TextureKind::kFractalNoise
               ? FractalNoise(c.p, c.dpdx, c.dpdy, settings.roughness, settings.octaves)
               : Turbulence(c.p, c.dpdx, c.dpdy, settings.roughness, settings.octaves);
  }
};

struct SpectrumEvaluation {
  using Value = SampledSpectrum;
  const TextureNodes& nodes;
  const TextureContext& context;
  const SampledWavelengths& wavelengths;

  SampledSpectrum Operand(const TextureNode& node, int i) const {
    const SpectrumInput& input = nodes.spectrum_operands[node.operand + i];
    return input.IsConstant() ? input.constant.Sample(wavelengths)
                              : EvaluateSpectrumTexture(nodes, input.texture, context, wavelengths);
  }
  float Float(const FloatInput& input) const { return FloatEvaluation{nodes, context}.Float(input); }
  SampledSpectrum Image(const ImageTexture& image, const TextureCoordinates2& c) const {
    const Point2 st{c.st.x, 1 - c.st.y};
    Float4 rgb = image.map->channels() == 1 ? Float4(image.map->LookUpGrey(st, c.dx, c.dy, image.filter))
                                            : image.map->LookUpColor(st, c.dx, c.dy, image.filter);
    rgb *= image.scale;
    rgb = Max(image.invert ? Float4(1.0f) - rgb : rgb, Float4(0.0f));
    if (image.use == SpectrumUse::kAlbedo) rgb = Min(rgb, Float4(1.0f));
    alignas(16) float v[4];
    _mm_store_ps(v, rgb.v);
    return ColorSpace::Srgb().SampleFast({v[0], v[1], v[2]}, image.use, wavelengths);
  }
  SampledSpectrum Procedural(const TextureNode& node) const {
    const TextureCoordinates3 c = nodes.mappings[node.mapping].Map3(context);
    const Vec3 rgb = MarbleColor(c, nodes.noises[node.detail]);
    return ColorSpace::Srgb().SampleFast(rgb, SpectrumUse::kAlbedo, wavelengths);
  }
};

// Operand 0 for weight 0, operand 1 for weight 1. What has no weight is not evaluated.
template <typename Evaluation>
typename Evaluation::Value Blend(const Evaluation& e, const TextureNode& node, float weight) {
  if (weight == 0) return e.Operand(node, 0);
  if (weight == 1) return e.Operand(node, 1);
  return (1 - weight) * e.Operand(node, 0) + weight * e.Operand(node, 1);
}

template <typename Evaluation>
typename Evaluation::Value Bilerp(const Evaluation& e, const TextureNode& node, Point2 st) {
  return (1 - st.x) * (1 - st.y) * e.Operand(node, 0) + (1 - st.x) * st.y * e.Operand(node, 1) +
         st.x * (1 - st.y) * e.Operand(node, 2) + st.x * st.y * e.Operand(node, 3);
}

template <typename Evaluation>
typename Evaluation::Value Evaluate(const Evaluation& e, const TextureNode& node) {
  const auto map2 = [&] { return e.nodes.mappings[node.mapping].Map2(e.context); };
  switch (node.kind) {
    case TextureKind::kScale: {
      const float amount = e.Float(node.amount);
      return amount == 0 ? typename Evaluation::Value{} : e.Operand(node, 0) * amount;
    }
    case TextureKind::kMix: return Blend(e, node, e.Float(node.amount));
    case TextureKind::kDirectionMix:
      return Blend(e, node, 1 - AbsDot(e.context.n, e.nodes.directions[node.detail]));
    case TextureKind::kBilerp: return Bilerp(e, node, map2().st);
    case TextureKind::kCheckerboard2: return Blend(e, node, CheckerboardWeight(map2()));
    case TextureKind::kCheckerboard3:
      return Blend(e, node, CheckerboardWeight(e.nodes.mappings[node.mapping].Map3(e.context)));
    case TextureKind::kDots: return e.Operand(node, InsideDot(map2().st) ? 1 : 0);
    case TextureKind::kImage: return e.Image(e.nodes.images[node.detail], map2());
    default: return e.Procedural(node);
  }
}

}  // namespace

float EvaluateFloatTexture(const TextureNodes& nodes, int texture, const TextureContext& context) {
  return Evaluate(FloatEvaluation{nodes, context}, nodes.floats[texture]);
}

SampledSpectrum EvaluateSpectrumTexture(const TextureNodes& nodes, int texture, const TextureContext& context,
                                        const SampledWavelengths& wavelengths) {
  return Evaluate(SpectrumEvaluation{nodes, context, wavelengths}, nodes.spectra[texture]);
}

TextureTable::TextureTable() : data_(std::make_unique<Data>()) {}
TextureTable::~TextureTable() = default;
TextureTable::TextureTable(TextureTable&&) noexcept = default;
TextureTable& TextureTable::operator=(TextureTable&&) noexcept = default;

float TextureTable::EvaluateFloatNode(int texture, const TextureContext& context) const {
  return EvaluateFloatTexture(data_->nodes, texture, context);
}

SampledSpectrum TextureTable::EvaluateSpectrumNode(int texture, const TextureContext& context,
                                                   const SampledWavelengths& wavelengths) const {
  return EvaluateSpectrumTexture(data_->nodes, texture, context, wavelengths);
}

size_t TextureTable::bytes() const {
  size_t sum = 0;
  for (const auto& map : data_->nodes.maps) sum += map->bytes();
  return sum;
}

}  // namespace tessera
