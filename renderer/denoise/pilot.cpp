#include "renderer/denoise/pilot.h"

#include <algorithm>

#include "renderer/util/parallel.h"

namespace tessera {
namespace {

constexpr int kPilotMargin = kStripMargin + kSmoothRadius;

// The part of the variance of the picture that remains in the pilot at least: weights of both halves have
// errors in common, which their difference does not show.
constexpr float kRemainingNoise = 0.01f;

}  // namespace

Pilot::Pilot(int width, int height)
    : width_(width),
      height_(height),
      values_(static_cast<size_t>(width) * static_cast<size_t>(height) * kValues) {}

void Pilot::LoadRow(int y) {
  const float* pixel = &values_[RowStart(Mirrored(y, height_))];
  for (int x = 0; x < width_; ++x, pixel += kValues) {
    for (size_t c = 0; c < kColors; ++c) {
      *halves_[0][c].At(x, y) = pixel[c];
      *halves_[1][c].At(x, y) = pixel[kColors + c];
      *mean_[c].At(x, y) = 0.5f * (pixel[c] + pixel[kColors + c]);
    }
  }
  for (size_t c = 0; c < kColors; ++c) {
    for (auto& half : halves_) MirrorRow(half[c], y, width_, kPilotMargin);
    MirrorRow(mean_[c], y, width_, kPilotMargin);
  }
}

// The variance of the mean of two is a quarter of their squared difference.
void Pilot::SmoothRow(int y, const Strip& strip) {
  for (size_t c = 0; c < kColors; ++c) {
    SmoothSquaredDifferences(halves_[0][c], halves_[1][c], y, width_, 0.25f, variance_[c]);
    float* const variance = variance_[c].At(0, y);
    const float* const of_picture = strip.variance[c].At(0, y);
    for (int x = 0; x < width_; ++x) variance[x] += kRemainingNoise * of_picture[x];
    MirrorRow(variance_[c], y, width_, kStripMargin);
  }
}

Result<void> Pilot::Load(const Strip& strip, int y0, int y1, int threads, const std::stop_token& stop) {
  const auto resize = [&](Plane& plane) {
    // Tiles are read as a whole, the last ones of a row beyond the margin as well.
    plane.Resize(-kPilotMargin, width_ + 2 * kPilotMargin + kTile, y0 - kPilotMargin,
                 y1 - y0 + 2 * kPilotMargin);
  };
  for (auto& half : halves_) std::ranges::for_each(half, resize);
  std::ranges::for_each(mean_, resize);
  std::ranges::for_each(variance_, resize);
  // Calls `body` for the rows within `margin` of the strip.
  const auto for_rows = [&](int margin, const auto& body) {
    const int rows = y1 - y0 + 2 * margin;
    return ForEachItem(static_cast<size_t>(rows), threads, stop,
                       [&](size_t i) { body(y0 - margin + static_cast<int>(i)); });
  };
  if (auto ok = for_rows(kPilotMargin, [&](int y) { LoadRow(y); }); !ok) return ok;
  return for_rows(kStripMargin, [&](int y) { SmoothRow(y, strip); });
}

}  // namespace tessera
