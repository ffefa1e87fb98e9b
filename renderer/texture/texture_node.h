// How the textures of a scene lie in memory: flat lists of small nodes that name each other by index.
#pragma once

#include <memory>
#include <vector>

#include "renderer/texture/mip_map.h"
#include "renderer/texture/patterns.h"
#include "renderer/texture/texture.h"
#include "renderer/texture/texture_mapping.h"

namespace tessera {

enum class TextureKind : uint8_t {
  kScale,          // operand 0 times amount
  kMix,            // operands 0 and 1, by amount
  kDirectionMix,   // operands 1 and 0, by |n . direction|; detail: in directions
  kBilerp,         // operands at (0,0), (0,1), (1,0), (1,1)
  kCheckerboard2,  // operands 0 and 1
  kCheckerboard3,  // the same
  kDots,           // operand 0 between the dots, 1 inside
  kImage,          // detail: in images
  kFractalNoise,   // detail: in noises; float only
  kTurbulence,     // the same
  kWindy,          // float only
  kMarble,         // detail: in noises; spectrum only
};

struct TextureNode {
  TextureKind kind = TextureKind::kScale;
  int mapping = -1;  // in mappings
  int operand = -1;  // of the first operand
  int detail = -1;
  FloatInput amount;
};

struct ImageTexture {
  const MipMap* map = nullptr;
  ImageFilterSettings filter;
  float scale = 1;
  bool invert = false;
  SpectrumUse use = SpectrumUse::kAlbedo;  // of a spectrum texture
};

// Each node refers only to nodes made before it; the builder bounds depth and cost.
struct TextureNodes {
  std::vector<TextureNode> floats, spectra;
  std::vector<FloatInput> float_operands;
  std::vector<SpectrumInput> spectrum_operands;
  std::vector<TextureMapping> mappings;
  std::vector<ImageTexture> images;
  std::vector<NoiseSettings> noises;
  std::vector<Vec3> directions;
  std::vector<std::shared_ptr<const MipMap>> maps;  // shared with other scenes that have the same picture
};

struct TextureTable::Data {
  TextureNodes nodes;
};

float EvaluateFloatTexture(const TextureNodes& nodes, int texture, const TextureContext& context);
SampledSpectrum EvaluateSpectrumTexture(const TextureNodes& nodes, int texture, const TextureContext& context,
                                        const SampledWavelengths& wavelengths);

}  // namespace tessera
