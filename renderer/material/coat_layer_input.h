// The layer between a coat and its base, as materials describe it.
#pragma once

#include "renderer/bxdf/coat_layer.h"
#include "renderer/material/material_inputs.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: spectrum texture albedo (0), float textures thickness (0.01) and g (0), integer maxdepth (10)
// and nsamples (1).
struct CoatLayerInput {
  static constexpr int kDepthMax = 1000;    // events of a walk between layers: more cannot be seen
  static constexpr int kSamplesMax = 1024;  // walks per evaluation

  SpectrumInput albedo;
  FloatInput thickness, g;
  int depth_max = 10, sample_count = 1;

  static CoatLayerInput Read(MaterialReader& reader);
  bool IsConstant() const { return !AnyTexture(albedo, thickness, g); }
  // Whether nothing is ever scattered in the layer.
  bool IsClear() const { return albedo.IsConstant() && !(albedo.constant.MaxValue() > 0); }
  CoatLayer Evaluate(const MaterialContext& at) const;
};

}  // namespace tessera
