// Nets: point sets that are stratified in every way that their size allows.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <vector>

#include "renderer/math/vec.h"

namespace tessera {

// Every elementary interval of volume 1/2^k holds exactly one of the first 2^k points: the definition of a
// (0, k, 2)-net.
inline void ExpectNet(const std::vector<Point2>& points) {
  const int log2_count = std::bit_width(points.size()) - 1;
  for (int k = 0; k <= log2_count; ++k) {
    const int columns = 1 << k, rows = 1 << (log2_count - k);
    std::set<int> cells;
    for (Point2 p : points) {
      cells.insert(static_cast<int>(p.x * static_cast<float>(columns)) * rows +
                   static_cast<int>(p.y * static_cast<float>(rows)));
    }
    EXPECT_EQ(cells.size(), points.size()) << columns << " x " << rows;
  }
}

}  // namespace tessera
