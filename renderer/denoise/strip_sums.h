// What the pixels of a strip have received from the fits around them.
#pragma once

#include <vector>

#include "renderer/denoise/local_regression.h"
#include "renderer/denoise/strip.h"

namespace tessera {

// Rows of a strip. Its margins, which are loaded twice, are a seventh of it.
constexpr int kStripHeight = 6 * kTile;

// Sums of the pixels of a strip and of kWindowRadius rows around it.
class StripSums {
 public:
  StripSums(int width, size_t signals);

  // Moves on to the next strip. Its first rows have received from the last one.
  void NextStrip();
  // Adds what a tile contributes; `y0` counts from the strip's first row.
  void Add(const TileContributions& tile, int x0, int y0);
  // Stores the fit of a signal at the pixels of a row of the strip; `step` floats are between them.
  void FitRow(size_t signal, int y, float* fit, size_t step) const;

 private:
  void Clear(int y0, int rows);

  const int width_;
  std::vector<Plane> sums_;  // of weights, then of each signal
};

}  // namespace tessera
