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

  explicit TileContributions(size_t signals) : sums(1 + signals) {}
  // Of pixels from kWindowRadius before the tile on: the sum of weights, then those of weights times each
  // signal.
  std::vector<Sums> sums;
};

// Minimises over b the sum over the pixels q of the window of
//     w(p, q) (signal(q) - b0 - sum_i b_i (feature_i(q) - feature_i(p)))^2
// for each pixel p of a tile and each signal: a colour, or a colour of the light of a group. Used by one
// thread.
class LocalRegression {
 public:
  // `ridge` is added to the diagonal of the features, relative to the sum of weights: a feature whose
  // standard deviation is below its square root (of an albedo or normal, or a part of a depth) hardly
  // matters. The same holds for features whose standard deviation is little more than their noise where
  // paths through glass are chosen at random; fits would reproduce it in the colours.
  LocalRegression(size_t signals, float ridge);
  ~LocalRegression();

  // Fits the signals and adds w(p, q) times the fit of p at q to the contributions of q.
  void Fit(const Strip& strip, const std::vector<const Plane*>& signals, const TilePlace& tile,
           const PatchWeights& weights, TileContributions& contributions);

 private:
  struct Row;  // of the tile: its equations and their solutions
  const std::unique_ptr<Row> row_;
};

}  // namespace tessera
