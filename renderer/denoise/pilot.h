// The halves of the picture as the first pass denoised them, which guide the second one.
#pragma once

#include <array>
#include <cstddef>
#include <stop_token>
#include <vector>

#include "renderer/denoise/patch_weights.h"
#include "renderer/denoise/plane.h"
#include "renderer/denoise/strip.h"
#include "renderer/util/result.h"

namespace tessera {

class Pilot {
 public:
  static constexpr size_t kValues = 2 * kColors;  // of a pixel: colours of the halves, divided by the albedo

  Pilot(int width, int height);

  float* Row(int y) { return &values_[RowStart(y)]; }
  // Prepares the rows from y0 to y1, those of `strip`, and kStripMargin rows around them. Errors as those of
  // ForEachItem.
  Result<void> Load(const Strip& strip, int y0, int y1, int threads, const std::stop_token& stop);
  // Of the rows that are loaded: the mean of the halves, and its variance by their difference and by that of
  // the picture.
  Guide guide() const { return {mean_, variance_}; }

 private:
  size_t RowStart(int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width_) * kValues; }
  void LoadRow(int y);
  void SmoothRow(int y, const Strip& strip);

  const int width_, height_;
  std::vector<float> values_;
  std::array<std::array<Plane, kColors>, 2> halves_;
  std::array<Plane, kColors> mean_, variance_;
};

}  // namespace tessera
