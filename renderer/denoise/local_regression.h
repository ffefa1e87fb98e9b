// Fits the colours around each pixel of a tile by linear functions of the features.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "renderer/denoise/patch_weights.h"
#include "renderer/denoise/strip.h"

namespace tessera {

// What the fits of the pixels of a tile contribute to the pixels around.
struct TileContributions {
  static constexpr int kSide = kTile + 2 * kWindowRadius;
  using Sums = std::array<std::array<float, kSide>, kSide>;

  explicit TileContributions(size_t groups) : sums(SumCount(groups)) {}
  // Sums of weights times colours, then of weights, then of weights times the light of each group, of pixels
  // from kWindowRadius before the tile on.
  std::vector<Sums> sums;

  static size_t SumCount(size_t groups) { return kColors + 1 + groups * kColors; }
  static constexpr size_t kWeight = kColors;
};

// Minimises over b the sum over the pixels q of the window of
//     w(p, q) (color(q) - b0 - sum_i b_i (feature_i(q) - feature_i(p)))^2
// for each pixel p of a tile. Used by one thread.
class LocalRegression {
 public:
  explicit LocalRegression(size_t groups);
  ~LocalRegression();

  // Fits the colours of one half, and the light of all groups, and adds w(p, q) times the fit of p at q to
  // the contributions of q.
  void Fit(const Strip& strip, size_t half, const TilePlace& tile, const PatchWeights& weights,
           TileContributions& contributions);

 private:
  struct Row;  // of the tile: its equations and their solutions
  const std::unique_ptr<Row> row_;
};

}  // namespace tessera
