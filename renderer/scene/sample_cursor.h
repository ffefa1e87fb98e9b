// The samples of a tile, in order.
#pragma once

#include <atomic>

#include "renderer/film/pixel_mask.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/film/sample_range.h"

namespace tessera {

// What is to be rendered: samples `range` of the pixels of `bounds` that `pixels` has. `stop` may be null.
struct TileWork {
  PixelBounds bounds;
  const PixelMask& pixels;
  SampleRange range;
  const std::atomic<bool>* stop;

  bool IsStopped() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
};

// The samples of a tile in the order in which a TileBuilder takes them.
class SampleCursor {
 public:
  explicit SampleCursor(const TileWork& work)
      : work_(work), x_(work.bounds.x0), y_(work.bounds.y0), index_(work.range.begin) {}

  bool at_end() const { return y_ == work_.bounds.y1; }
  // Whether the pixel has samples; if not, only NextPixel may follow.
  bool HasSamples() const { return work_.pixels.Has(pixel_); }
  int x() const { return x_; }
  int y() const { return y_; }
  uint32_t index() const { return index_; }
  // Returns whether that was the last of its pixel.
  bool Next() {
    if (++index_ != work_.range.end()) return false;
    NextPixel();
    return true;
  }
  void NextPixel() {
    index_ = work_.range.begin;
    ++pixel_;
    if (++x_ == work_.bounds.x1) {
      x_ = work_.bounds.x0;
      ++y_;
    }
  }

 private:
  const TileWork& work_;
  int x_, y_;
  uint32_t index_;
  size_t pixel_ = 0;
};

}  // namespace tessera
