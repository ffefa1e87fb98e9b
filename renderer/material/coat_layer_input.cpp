#include "renderer/material/coat_layer_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

int IntegerInRange(ParameterReader& parameters, const char* name, int default_value, int min, int max) {
  const int value = parameters.Integer(name, default_value);
  if (value < min || value > max) {
    parameters.FailAt(name, fmt::format("\"{}\" of a coat must be from {} to {}", name, min, max));
  }
  return value;
}

}  // namespace

CoatLayerInput CoatLayerInput::Read(MaterialReader& reader) {
  CoatLayerInput layer;
  layer.albedo = reader.Albedo("albedo", 0);
  layer.thickness = reader.Float("thickness", 0.01f);
  layer.thickness.constant = std::max(layer.thickness.constant, std::numeric_limits<float>::min());
  layer.g = reader.Float("g", 0);
  layer.depth_max = IntegerInRange(reader.parameters, "maxdepth", 10, 0, kDepthMax);
  layer.sample_count = IntegerInRange(reader.parameters, "nsamples", 1, 1, kSamplesMax);
  return layer;
}

CoatLayer CoatLayerInput::Evaluate(const MaterialContext& at) const {
  CoatLayer layer;
  layer.thickness = std::max(std::numeric_limits<float>::min(), at(thickness));
  layer.albedo = Clamp(at(albedo), 0, 1);
  layer.g = std::clamp(at(g), -1.0f, 1.0f);
  layer.depth_max = depth_max;
  layer.sample_count = sample_count;
  return layer;
}

}  // namespace tessera
