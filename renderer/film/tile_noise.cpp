#include "renderer/film/tile_noise.h"

#include "renderer/film/adaptive.h"

namespace tessera {
namespace {

// Every fifth pixel counts: a tile of 32 x 32 has 200 of them, and the mean of a frame those of all its
// tiles.
constexpr size_t kPixelStep = 5;

}  // namespace

void TileNoise::Measure(const ChannelLayout& layout, std::span<const float> left,
                        std::span<const float> right, const PixelMask& going_on) {
  if (layout.colors().empty()) return;
  const size_t stride = layout.shape().stride();
  open_ = 0;
  pixels_ = 0;
  for (size_t p = 0; p * stride < left.size(); p += kPixelStep) {
    ++pixels_;
    const float* const a = &left[p * stride];
    const float* const b = &right[p * stride];
    if (a[layout.weight()] == 0 || b[layout.weight()] == 0) continue;
    (going_on.Has(p) ? open_ : stopped_) += PixelNoise(layout, a, b);
  }
}

}  // namespace tessera
