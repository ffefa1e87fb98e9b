// Sums over the fixed binary tree of sample indices.
#pragma once

#include <array>
#include <cstdint>

#include "renderer/film/sample_range.h"
#include "renderer/util/check.h"

namespace tessera {

// Adds the samples of one pixel in index order so that the result is the tree node of their range. Works like
// a binary counter: it holds one partial sum per bit that is set in the count of samples. T has operator+.
template <typename T>
class DyadicSum {
 public:
  void Add(T value) {
    uint32_t carries = count_++;
    while (carries & 1) {
      value = partial_[--depth_] + value;  // left + right, in that order
      carries >>= 1;
    }
    partial_[depth_++] = value;
  }
  // The node; the count of samples added must be a power of two.
  T Node() const {
    TESSERA_CHECK(depth_ == 1);
    return partial_[0];
  }
  void Clear() { count_ = depth_ = 0; }

 private:
  std::array<T, 21> partial_{};  // kSamplesPerPixelMax = 2^20
  uint32_t count_ = 0;
  uint32_t depth_ = 0;
};

}  // namespace tessera
