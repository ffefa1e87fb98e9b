// What a picture stream can show of a frame: its colours, the layers of its file, and what is known of its
// progress.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/film/frame_spec.h"

namespace tessera {

// The number of samples that pixels show. Names of channels have no "~".
constexpr const char* kSamplesLayer = "~samples";
// The root of the relMSE that pixels are expected to have.
constexpr const char* kNoiseLayer = "~noise";
// All light groups: red, green and blue of each.
constexpr const char* kLightsLayer = "~lights";

struct PictureLayer {
  std::string name;  // "" for the colours, "albedo", "depth", "A", "~samples", ...
  std::vector<std::string>
      channels;           // of the file, a few; those of a layer of progress have names of their own
  bool is_exact = false;  // 32-bit floats, whatever the precision of the file
  bool operator==(const PictureLayer&) const = default;
};

// In the order of the file, the colours first.
std::vector<PictureLayer> LayersOf(const FrameSpec& spec);
// Returns nullopt if the frame has no such layer.
std::optional<PictureLayer> FindLayer(const FrameSpec& spec, const std::string& name);

}  // namespace tessera
