#include "renderer/texture/texture.h"

#include "renderer/color/color_space.h"
#include "renderer/util/dispatch.h"

namespace tessera {
namespace {

float EvaluateFloat(const TextureNodes& nodes, int texture, const TextureContext& context);
SampledSpectrum EvaluateSpectrum(const TextureNodes& nodes, int texture, const TextureContext& context,
                                 const SampledWavelengths& wavelengths);

// What the kinds of texture evaluate themselves with. The two types of value differ only in how operands and
// images are read.
struct FloatEvaluation {
  using Value = float;
  const TextureNodes& nodes;
  const TextureContext& context;

  float Float(const FloatInput& input) const {
    return input.IsConstant() ? input.constant : EvaluateFloat(nodes, input.texture, context);
  }
  float Operand(int operand) const { return Float(nodes.float_operands[operand]); }
  TextureCoordinates2 Map2(int mapping) const { return nodes.mappings[mapping].Map2(context); }
  TextureCoordinates3 Map3(int mapping) const { return nodes.mappings[mapping].Map3(context); }
  float Image(const ImageTexture& image, const TextureCoordinates2& c) const {
    const float v = image.scale * image.map->LookUpGrey({c.st.x, 1 - c.st.y}, c.dx, c.dy, image.filter);
    return image.invert ? std::max(0.0f, 1 - v) : v;
  }
};

struct SpectrumEvaluation {
  using Value = SampledSpectrum;
  const TextureNodes& nodes;
  const TextureContext& context;
  const SampledWavelengths& wavelengths;

  float Float(const FloatInput& input) const { return FloatEvaluation{nodes, context}.Float(input); }
  SampledSpectrum Operand(int operand) const {
    const SpectrumInput& input = nodes.spectrum_operands[operand];
    return input.IsConstant() ? input.constant.Sample(wavelengths)
                              : EvaluateSpectrum(nodes, input.texture, context, wavelengths);
  }
  TextureCoordinates2 Map2(int mapping) const { return nodes.mappings[mapping].Map2(context); }
  TextureCoordinates3 Map3(int mapping) const { return nodes.mappings[mapping].Map3(context); }
  SampledSpectrum Image(const ImageTexture& image, const TextureCoordinates2& c) const {
    const Point2 st{c.st.x, 1 - c.st.y};
    Float4 rgb = image.map->channels() == 1 ? Float4(image.map->LookUpGrey(st, c.dx, c.dy, image.filter))
                                            : image.map->LookUpColor(st, c.dx, c.dy, image.filter);
    rgb *= image.scale;
    rgb = Max(image.invert ? Float4(1.0f) - rgb : rgb, Float4(0.0f));
    if (image.use == SpectrumUse::kAlbedo) rgb = Min(rgb, Float4(1.0f));
    alignas(16) float v[4];
    _mm_store_ps(v, rgb.v);
    return image.color_space->SampleFast({v[0], v[1], v[2]}, image.use, wavelengths);
  }
  SampledSpectrum Albedo(Vec3 rgb) const {
    return ColorSpace::Srgb().SampleFast(rgb, SpectrumUse::kAlbedo, wavelengths);
  }
};

float EvaluateFloat(const TextureNodes& nodes, int texture, const TextureContext& context) {
  const FloatEvaluation evaluation{nodes, context};
  return Dispatch(nodes.floats[texture], [&](const auto& kind) { return kind.Evaluate(evaluation); });
}

SampledSpectrum EvaluateSpectrum(const TextureNodes& nodes, int texture, const TextureContext& context,
                                 const SampledWavelengths& wavelengths) {
  const SpectrumEvaluation evaluation{nodes, context, wavelengths};
  return Dispatch(nodes.spectra[texture], [&](const auto& kind) { return kind.Evaluate(evaluation); });
}

}  // namespace

float TextureTable::EvaluateFloatNode(int texture, const TextureContext& context) const {
  return EvaluateFloat(nodes_, texture, context);
}

SampledSpectrum TextureTable::EvaluateSpectrumNode(int texture, const TextureContext& context,
                                                   const SampledWavelengths& wavelengths) const {
  return EvaluateSpectrum(nodes_, texture, context, wavelengths);
}

size_t TextureTable::bytes() const {
  size_t sum = 0;
  for (const auto& map : nodes_.maps) sum += map->bytes();
  return sum;
}

}  // namespace tessera
