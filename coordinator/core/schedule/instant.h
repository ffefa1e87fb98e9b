// Time in the core: the duration since an origin that only the caller knows. The core never reads a clock.
#pragma once

#include <chrono>

namespace tessera {

using Instant = std::chrono::microseconds;

constexpr double Seconds(Instant duration) {
  return std::chrono::duration<double>(duration).count();
}
// The seconds must be finite. Clamped to [0, one century], which keeps sums in range.
constexpr Instant FromSeconds(double seconds) {
  constexpr double kCentury_s = 3.2e9;
  const double kept = seconds < 0 ? 0 : seconds < kCentury_s ? seconds : kCentury_s;
  return Instant(static_cast<Instant::rep>(kept * 1e6));
}

}  // namespace tessera
