#include "renderer/film/sample_range.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/util/check.h"

namespace tessera {

std::string SampleRange::Text() const {
  return fmt::format("[{},{})", begin, end());
}

uint32_t DyadicSizeMax(uint32_t begin, uint32_t end) {
  TESSERA_CHECK(begin < end);
  const uint32_t fitting = std::bit_floor(end - begin);
  const uint32_t aligned = begin == 0 ? fitting : begin & (~begin + 1);
  return std::min(fitting, aligned);
}

std::vector<SampleRange> DyadicPartition(uint32_t samples) {
  TESSERA_CHECK(samples <= kSamplesPerPixelMax);
  std::vector<SampleRange> ranges;
  uint32_t begin = 0;
  while (begin < samples) {
    const uint32_t size = DyadicSizeMax(begin, samples);
    ranges.push_back({begin, size});
    begin += size;
  }
  return ranges;
}

}  // namespace tessera
