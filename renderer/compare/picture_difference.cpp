#include "renderer/compare/picture_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr double kRelativeFloor = 0.01;  // added to b^2, so that black pixels do not decide relMSE

// Sums over pairs of values, in the order of the pixels.
struct Totals {
  double squared = 0, relative = 0, maxabs = 0;
  uint64_t count = 0;
  bool same_bits = true;

  void Add(float a, float b) {
    ++count;
    if (std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b)) return;
    same_bits = false;
    if (a == b) return;  // zeros of both signs
    double difference = static_cast<double>(a) - b;
    if (!std::isfinite(difference)) difference = std::numeric_limits<double>::infinity();
    const double squared_difference = difference * difference;
    squared += squared_difference;
    const double reference = std::isfinite(b) ? static_cast<double>(b) : 0.0;
    relative += squared_difference / (reference * reference + kRelativeFloor);
    maxabs = std::max(maxabs, std::abs(difference));
  }
};

}  // namespace

Result<PictureDifference> Compare(const LoadedPicture& a, const LoadedPicture& b) {
  if (a.width != b.width || a.height != b.height || a.bounds != b.bounds) {
    return BadInput(fmt::format("the pictures differ in size: {}x{} of {}x{} and {}x{} of {}x{}",
                                a.bounds.width(), a.bounds.height(), a.width, a.height, b.bounds.width(),
                                b.bounds.height(), b.width, b.height));
  }
  Totals totals;
  const size_t pixels = static_cast<size_t>(a.bounds.area());
  for (size_t ca = 0; ca < a.channels.size(); ++ca) {
    const auto found = std::ranges::find(b.channels, a.channels[ca]);
    if (found == b.channels.end()) continue;
    const size_t cb = static_cast<size_t>(found - b.channels.begin());
    for (size_t i = 0; i < pixels; ++i) {
      totals.Add(a.values[i * a.channels.size() + ca], b.values[i * b.channels.size() + cb]);
    }
  }
  if (totals.count == 0) return BadInput("the pictures have no channel in common");
  PictureDifference difference;
  const double count = static_cast<double>(totals.count);
  difference.mse = totals.squared / count;
  difference.relmse = totals.relative / count;
  difference.psnr_db = -10.0 * std::log10(difference.mse);  // infinity for equal pictures
  difference.maxabs = totals.maxabs;
  difference.identical = totals.same_bits && a.channels == b.channels;
  return difference;
}

}  // namespace tessera
