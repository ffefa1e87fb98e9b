// Builds the lists of nodes. Bounds the cost of a lookup and folds constants.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "renderer/texture/texture_node.h"

namespace tessera {

// Textures within textures: deeper than any scene we know.
constexpr int kTextureDepthMax = 64;
// Nodes that one lookup may visit: a chain of mixes can double the number at each link.
constexpr int kTextureCostMax = 4096;

class TextureAssembly {
 public:
  int AddMapping(const TextureMapping& mapping);
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

  // Adds a node whose operands are `operands`; `amount` is its amount, if it has one. Returns nullopt if a
  // limit is exceeded.
  std::optional<FloatInput> AddFloat(FloatTextureNode node, std::span<const FloatInput> operands = {},
                                     const FloatInput& amount = {});
  std::optional<SpectrumInput> AddSpectrum(SpectrumTextureNode node,
                                           std::span<const SpectrumInput> operands = {},
                                           const FloatInput& amount = {});

  // `input` times `factor`. As in pbrt, an image's own scale is changed, before it is inverted and clamped.
  // Returns nullopt if a limit is exceeded.
  std::optional<FloatInput> Scaled(const FloatInput& input, float factor);
  std::optional<SpectrumInput> Scaled(const SpectrumInput& input, float factor);
  std::optional<FloatInput> Scaled(const FloatInput& input, const FloatInput& factor);
  std::optional<SpectrumInput> Scaled(const SpectrumInput& input, const FloatInput& factor);

  TextureNodes Take() { return std::move(nodes_); }
  const TextureNodes& nodes() const { return nodes_; }

 private:
  // The cost of looking up a node with all its operands.
  struct Size {
    int depth = 0;
    int cost = 0;
  };
  static void Include(Size& size, Size part);
  Size SizeOf(const FloatInput& input) const;
  Size SizeOf(const SpectrumInput& input) const;
  static bool IsAllowed(Size size) { return size.depth <= kTextureDepthMax && size.cost <= kTextureCostMax; }
  // The node of an input that is an image, else null.
  const ImageTexture* FindImage(const FloatInput& input) const;
  const ImageTexture* FindImage(const SpectrumInput& input) const;

  TextureNodes nodes_;
  std::vector<Size> float_sizes_, spectrum_sizes_;
  std::map<std::string, std::shared_ptr<const MipMap>> maps_by_key_;
};

}  // namespace tessera
