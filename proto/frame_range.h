// Which frames of a sequence: `A-B[xSTEP]`.
#pragma once

#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

constexpr int kFrameNumberMax = 99'999'999;  // eight digits: no film is as long

struct FrameRange {
  int first = 0, last = 0, step = 1;  // first <= last; `last` may lie between two steps

  std::vector<int> Numbers() const;
  bool operator==(const FrameRange&) const = default;
};

// Reads "A-B", "A-BxSTEP" or "A", none negative. Errors name `flag`. A range that is empty or has more than
// kFramesPerJobMax frames is an error.
Result<FrameRange> ParseFrameRange(std::string_view flag, std::string_view text);

}  // namespace tessera
