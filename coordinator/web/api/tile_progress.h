// How far the pixels of a tile are: their samples, and the noise that these leave.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "renderer/film/frame_snapshot.h"

namespace tessera {

// The number of samples of each pixel of the tile that the snapshot shows.
std::vector<float> SamplesOfTile(const FrameSpec& spec, const FrameSnapshot::TileNodes& nodes,
                                 const PixelBounds& bounds);

// The root of the relMSE that each pixel is expected to have, from two parts of its samples, averaged over
// the pixels around. Returns nullopt if the tile has less than two parts.
std::optional<std::vector<float>> NoiseOfTile(const FrameSpec& spec, const FrameSnapshot::TileNodes& nodes,
                                              const PixelBounds& bounds);

// The same from the channels of a picture of that form: colours, and the variance of their means. Returns
// nullopt if the picture does not have them.
std::optional<std::vector<float>> NoiseFromVariance(const std::vector<std::string>& channels,
                                                    std::span<const float> values);

}  // namespace tessera
