#include "film/sample_range.h"

#include <fmt/format.h>

#include "util/check.h"

namespace tessera {

std::string SampleRange::Text() const {
  return fmt::format("[{},{})", begin, end());
}

std::vector<SampleRange> DyadicPartition(uint32_t samples) {
  TESSERA_CHECK(samples <= kSamplesPerPixelMax);
  std::vector<SampleRange> ranges;
  uint32_t begin = 0;
  while (begin < samples) {
    const uint32_t size = std::bit_floor(samples - begin);
    ranges.push_back({begin, size});
    begin += size;
  }
  return ranges;
}

}  // namespace tessera
