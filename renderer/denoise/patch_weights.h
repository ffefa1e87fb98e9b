// The weights with which the pixels around each pixel of a tile count for it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "renderer/denoise/strip.h"

namespace tessera {

constexpr int kWindow = 2 * kWindowRadius + 1;

// The pixels of the picture that a tile starts at, and its size.
struct TilePlace {
  int x0 = 0, y0 = 0;
  int width = 0, height = 0;  // of the whole picture
};

// What patches are compared in: colours and their variance.
struct Guide {
  const std::array<Plane, kColors>& colors;
  const std::array<Plane, kColors>& variance;
};

struct WeightSettings {
  // How different two pixels may be in units of their standard deviation: k of the paper.
  float tolerance = 1;
  int patch_radius = kPatchRadius;  // at most kPatchRadius
};

// Weights by non-local means (denoise.h names the source): those of two pixels depend on the difference of
// the patches around them in a guide, relative to its variance.
class PatchWeights {
 public:
  PatchWeights() : weights_(static_cast<size_t>(kWindow * kWindow * kTile * kTile)) {}

  void Compute(const Guide& guide, const WeightSettings& settings, const TilePlace& tile);
  // The weights of pixels at (dx, dy) from those of row y of the tile, kTile of them. 0 if one of the two is
  // not in the picture.
  const float* Row(int dx, int dy, int y) const {
    const int shift = (dy + kWindowRadius) * kWindow + dx + kWindowRadius;
    const int index = (shift * kTile + y) * kTile;
    return &weights_[static_cast<size_t>(index)];
  }

 private:
  std::vector<float> weights_;
};

}  // namespace tessera
