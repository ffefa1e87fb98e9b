// The noise that a tile has reached, for people: the mean over some of its pixels of q (adaptive.h), the
// relMSE that two halves of its samples are expected to have together. It decides nothing. Measuring costs a
// small part of what adding the halves does.
#pragma once

#include <cstddef>
#include <span>

#include "renderer/film/channel_layout.h"
#include "renderer/film/pixel_mask.h"

namespace tessera {

class TileNoise {
 public:
  // From the records of two halves of the same number of samples. Pixels that are not in `going_on` get no
  // more samples, and count from now on with what they have. Pixels without samples in both halves got no
  // more before.
  void Measure(const ChannelLayout& layout, std::span<const float> left, std::span<const float> right,
               const PixelMask& going_on);
  // Over the pixels that were measured.
  double sum() const { return open_ + stopped_; }
  size_t pixels() const { return pixels_; }  // 0: nothing is known

 private:
  double open_ = 0, stopped_ = 0;
  size_t pixels_ = 0;
};

}  // namespace tessera
