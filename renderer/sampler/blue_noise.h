// A mask whose values differ as much as they can between near pixels: numbers that vary with it give errors
// that neighbouring pixels cancel (Georgiev and Fajardo 2016).
#pragma once

#include <array>
#include <cstddef>

namespace tessera {

constexpr int kBlueNoiseSide = 64;  // pixels; the mask repeats beyond

class BlueNoise {
 public:
  // Made once, by the void-and-cluster method (Ulichney 1993), in whole numbers: the same on every machine.
  static const BlueNoise& Get();

  // In [0, 1): each multiple of 1 / kBlueNoiseSide^2 once. x and y must not be negative.
  float At(int x, int y) const {
    const int index = y % kBlueNoiseSide * kBlueNoiseSide + x % kBlueNoiseSide;
    return values_[static_cast<size_t>(index)];
  }

 private:
  friend class VoidAndCluster;
  BlueNoise() = default;

  std::array<float, kBlueNoiseSide * kBlueNoiseSide> values_{};
};

}  // namespace tessera
