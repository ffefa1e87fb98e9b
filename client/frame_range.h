// Which frames of a sequence: `A-B[xSTEP]`.
#pragma once

#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

constexpr int kFrameNumberMax = 99'999'999;  // of eight digits: no film is as long

struct FrameRange {
  int first = 0, last = 0, step = 1;  // first <= last; `last` may lie between two steps

  std::vector<int> Numbers() const;
  bool operator==(const FrameRange&) const = default;
};

// "A-B", "A-BxSTEP" or "A", none negative. An error if the range is empty or of more than kFramesPerJobMax
// frames.
Result<FrameRange> ParseFrameRange(std::string_view word);

}  // namespace tessera
