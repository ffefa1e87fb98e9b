// Textures: values that vary over surfaces. Built once per scene into a TextureTable, read by all threads.
#pragma once

#include <utility>

#include "renderer/texture/texture_node.h"

namespace tessera {

// All textures of a scene; immutable.
class TextureTable {
 public:
  TextureTable() = default;
  explicit TextureTable(TextureNodes nodes) : nodes_(std::move(nodes)) {}

  float Evaluate(const FloatInput& input, const TextureContext& context) const {
    return input.texture < 0 ? input.constant : EvaluateFloatNode(input.texture, context);
  }
  SampledSpectrum Evaluate(const SpectrumInput& input, const TextureContext& context,
                           const SampledWavelengths& wavelengths) const {
    return input.texture < 0 ? input.constant.Sample(wavelengths)
                             : EvaluateSpectrumNode(input.texture, context, wavelengths);
  }
  // Bytes of image data held.
  size_t bytes() const;

 private:
  float EvaluateFloatNode(int texture, const TextureContext& context) const;
  SampledSpectrum EvaluateSpectrumNode(int texture, const TextureContext& context,
                                       const SampledWavelengths& wavelengths) const;

  TextureNodes nodes_;
};

}  // namespace tessera
