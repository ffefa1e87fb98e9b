// The node lists while they grow. Bounds what one lookup can cost, and folds what is constant.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "renderer/texture/texture_node.h"

namespace tessera {

constexpr int kTextureDepthMax = 64;  // textures within textures: deeper than any scene we have met
constexpr int kTextureCostMax =
    4096;  // nodes that one lookup may visit: a chain of mixes can double at each link

class TextureAssembly {
 public:
  int AddMapping(TextureMapping mapping);
  int AddNoise(NoiseSettings settings);
  int AddDirection(Vec3 direction);
  // `make` is called unless a map with this key was added before.
  template <typename Make>
  std::shared_ptr<const MipMap> AddMap(const std::string& key, Make make) {
    const auto [place, is_new] = maps_by_key_.try_emplace(key, nullptr);
    if (is_new) {
      place->second = make();
      nodes_.maps.push_back(place->second);
    }
    return place->second;
  }

  // Nothing if a limit is exceeded.
  std::optional<FloatInput> AddFloat(TextureNode node, std::span<const FloatInput> operands);
  std::optional<SpectrumInput> AddSpectrum(TextureNode node, std::span<const SpectrumInput> operands);
  FloatInput AddFloatImage(const ImageTexture& image, int mapping);
  SpectrumInput AddSpectrumImage(const ImageTexture& image, int mapping);

  // `input` times `factor`. As in pbrt, an image's own scale is changed, before it is inverted and clamped.
  // Nothing if a limit is exceeded.
  std::optional<FloatInput> Scaled(const FloatInput& input, float factor);
  std::optional<SpectrumInput> Scaled(const SpectrumInput& input, float factor);
  std::optional<FloatInput> Scaled(const FloatInput& input, const FloatInput& factor);
  std::optional<SpectrumInput> Scaled(const SpectrumInput& input, const FloatInput& factor);

  TextureNodes Take() { return std::move(nodes_); }

 private:
  // What a lookup of a node takes, with all below it.
  struct Size {
    int depth = 0;
    int cost = 0;
  };
  static void Include(Size& size, Size part);
  Size SizeOf(const FloatInput& input) const;
  Size SizeOf(const SpectrumInput& input) const;
  static bool IsAllowed(Size size) { return size.depth <= kTextureDepthMax && size.cost <= kTextureCostMax; }
  bool IsImage(const FloatInput& input) const;
  bool IsImage(const SpectrumInput& input) const;

  TextureNodes nodes_;
  std::vector<Size> float_sizes_, spectrum_sizes_;
  std::map<std::string, std::shared_ptr<const MipMap>> maps_by_key_;
};

}  // namespace tessera
