// Fits the colours around each pixel of a tile by linear functions of the features.
#pragma once

#include <array>
#include <memory>

#include "renderer/denoise/patch_weights.h"
#include "renderer/denoise/strip.h"

namespace tessera {

// What the fits of the pixels of a tile contribute to the pixels around.
struct TileContributions {
  static constexpr int kSide = kTile + 2 * kWindowRadius;
  // Sums of weights times colours, then of weights, of pixels from kWindowRadius before the tile on.
  std::array<std::array<std::array<float, kSide>, kSide>, kColors + 1> sums{};
};

// Minimises over b the sum over the pixels q of the window of
//     w(p, q) (color(q) - b0 - sum_i b_i (feature_i(q) - feature_i(p)))^2
// for each pixel p of a tile. Used by one thread.
class LocalRegression {
 public:
  LocalRegression();
  ~LocalRegression();

  // Fits the colours of one half and adds w(p, q) times the fit of p at q to the contributions of q.
  void Fit(const Strip& strip, size_t half, const TilePlace& tile, const PatchWeights& weights,
           TileContributions& contributions);

 private:
  struct Row;  // of the tile: its equations and their solutions
  const std::unique_ptr<Row> row_;
};

}  // namespace tessera
