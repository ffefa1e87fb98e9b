#include "proto/frame_range.h"

#include <fmt/format.h>

#include <charconv>

#include "proto/terms.h"

namespace tessera {
namespace {

// Takes a number off the front of `text`.
bool TakeNumber(std::string_view& text, int* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  if (error != std::errc() || text.front() == '-' || *number > kFrameNumberMax) return false;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return true;
}

bool TakeCharacter(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

Error BadRange(std::string_view flag, std::string_view text, const std::string& what) {
  return BadInput(fmt::format("{} {}: {}", flag, text, what));
}

}  // namespace

std::vector<int> FrameRange::Numbers() const {
  std::vector<int> numbers;
  for (int64_t number = first; number <= last; number += step) numbers.push_back(static_cast<int>(number));
  return numbers;
}

Result<FrameRange> ParseFrameRange(std::string_view flag, std::string_view text) {
  FrameRange range;
  std::string_view rest = text;
  bool good = !rest.empty() && TakeNumber(rest, &range.first);
  range.last = range.first;
  if (good && TakeCharacter(rest, '-')) good = !rest.empty() && TakeNumber(rest, &range.last);
  if (good && TakeCharacter(rest, 'x')) good = !rest.empty() && TakeNumber(rest, &range.step);
  if (!good || !rest.empty()) {
    return BadRange(flag, text, "expected A-B or A-BxSTEP, such as 1-250 or 1-250x10");
  }
  if (range.step < 1) return BadRange(flag, text, "the step must be at least 1");
  if (range.last < range.first) return BadRange(flag, text, "the last frame comes before the first");
  const int64_t count = (int64_t{range.last} - range.first) / range.step + 1;
  if (count > kFramesPerJobMax) {
    return BadRange(flag, text, fmt::format("{} frames; a job has at most {}", count, kFramesPerJobMax));
  }
  return range;
}

}  // namespace tessera
