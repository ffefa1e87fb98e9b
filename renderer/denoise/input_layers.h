// Where a picture has the layers that denoising needs.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

constexpr size_t kColors = 3;

// The light of a group (renderer/film/relight.h), which is a part of the colours.
struct GroupLayer {
  std::string name;  // of the layer
  std::array<size_t, kColors> color{};
};

// Indices of channels.
struct InputLayers {
  std::array<size_t, kColors> color{}, halves{}, albedo{}, normal{};
  // Of what is seen in mirrors and through glass. A picture that lacks these layers has those of the first
  // surface here.
  std::array<size_t, kColors> guiding_albedo{}, guiding_normal{};
  size_t depth = 0;
  bool has_depth = false, has_halves = false;
  std::vector<GroupLayer> groups;
  // The means of the samples of the two halves are these times (color + halves) and (color - halves).
  std::array<float, 2> half_scales = {1, 1};
};

// `denoiser` does not need all. The error calls the picture `name`, lists the layers that are missing and
// says how they are rendered.
Result<InputLayers> FindInputLayers(const LoadedPicture& picture, const std::string& name, Denoiser denoiser);

// The largest finite depth, or 1 if there is none.
float LargestDepth(const LoadedPicture& picture, size_t depth);

}  // namespace tessera
