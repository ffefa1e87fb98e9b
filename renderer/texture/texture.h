// Textures: values that vary over surfaces. Built once per scene into a TextureTable, read by all threads.
#pragma once

#include <memory>
#include <string_view>

#include "renderer/color/spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

// Where a texture is looked up.
struct TextureContext {
  Point3 p;   // in rendering space
  Normal3 n;  // shading normal, for directional mixes
  Point2 uv;
  Vec3 dpdx, dpdy;                               // change of p per pixel of the image
  float dudx = 0, dudy = 0, dvdx = 0, dvdy = 0;  // change of uv per pixel
};

// A float that is either constant or a texture's.
struct FloatInput {
  float constant = 0;
  int texture = -1;  // index in the TextureTable, -1: constant
  bool IsConstant() const { return texture < 0; }
};

// A spectrum that is either constant or a texture's.
struct SpectrumInput {
  Spectrum constant;
  int texture = -1;
  bool IsConstant() const { return texture < 0; }
};

struct TextureNode;  // texture_node.h: one kind of texture with its inputs

// All textures of a scene; immutable.
class TextureTable {
 public:
  TextureTable();
  ~TextureTable();
  TextureTable(TextureTable&&) noexcept;
  TextureTable& operator=(TextureTable&&) noexcept;

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
  friend class TextureBuilder;
  float EvaluateFloatNode(int texture, const TextureContext& context) const;
  SampledSpectrum EvaluateSpectrumNode(int texture, const TextureContext& context,
                                       const SampledWavelengths& wavelengths) const;
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace tessera
