// The textures of a scene in memory: flat lists of nodes that refer to each other by index.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "renderer/color/color_space.h"
#include "renderer/texture/blend_textures.h"
#include "renderer/texture/mip_map.h"
#include "renderer/texture/noise_textures.h"
#include "renderer/texture/pattern_textures.h"
#include "renderer/texture/texture_mapping.h"

namespace tessera {

struct ImageTexture {
  const MipMap* map = nullptr;
  ImageFilterSettings filter;
  float scale = 1;
  bool invert = false;
  // Of a spectrum texture: what its spectra are used for, and the colour space of the map.
  SpectrumUse use = SpectrumUse::kAlbedo;
  const ColorSpace* color_space = nullptr;
  int mapping = -1;

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    return e.Image(*this, e.Map2(mapping));
  }
};

// The kinds of texture by type of value. Constants need no node.
using FloatTextureNode =
    std::variant<ScaleTexture, MixTexture, DirectionMixTexture, BilerpTexture, CheckerboardTexture,
                 DotsTexture, ImageTexture, FractalNoiseTexture, TurbulenceTexture, WindyTexture>;
using SpectrumTextureNode = std::variant<ScaleTexture, MixTexture, DirectionMixTexture, BilerpTexture,
                                         CheckerboardTexture, DotsTexture, ImageTexture, MarbleTexture>;

// Each node refers only to nodes made before it; the builder bounds depth and cost.
struct TextureNodes {
  std::vector<FloatTextureNode> floats;
  std::vector<SpectrumTextureNode> spectra;
  std::vector<FloatInput> float_operands;
  std::vector<SpectrumInput> spectrum_operands;
  std::vector<TextureMapping> mappings;
  std::vector<std::shared_ptr<const MipMap>> maps;  // shared with other scenes that have the same image
};

}  // namespace tessera
