// How much the frames of all jobs take that are begun and not complete: the bookkeeping of their tiles here,
// and the sums of their pixels in mergers. Owned by the job queue.
#pragma once

#include <cstdint>
#include <memory>

#include "coordinator/core/schedule/policy.h"
#include "renderer/film/frame_spec.h"

namespace tessera {

class ActiveFrames {
 public:
  struct Size {
    uint64_t frames = 0, tiles = 0, bytes = 0;
  };
  static Size SizeOf(const FrameSpec& spec) {
    const PixelShape shape = spec.Layout().shape();
    // Most pixels show few ids.
    const uint64_t floats = shape.stride() + uint64_t{shape.id_sets} * 8;
    return {1, static_cast<uint64_t>(spec.TileCount()),
            static_cast<uint64_t>(spec.crop.area()) * floats * sizeof(float)};
  }

  // Whether a frame of this size fits besides those that are active into `factor` times the limits. A single
  // frame may be of any size.
  bool HasRoom(const Size& frame, uint64_t factor = 1) const {
    return sum_->frames == 0 || (sum_->frames + frame.frames <= factor * kActiveFramesMax &&
                                 sum_->tiles + frame.tiles <= factor * kActiveTilesMax &&
                                 sum_->bytes + frame.bytes <= factor * kActiveBytesMax);
  }
  // Whether those that are active exceed `factor` times the limits.
  bool IsBeyond(uint64_t factor) const {
    return sum_->frames > factor * kActiveFramesMax || sum_->tiles > factor * kActiveTilesMax ||
           sum_->bytes > factor * kActiveBytesMax;
  }
  // Counts the frame until the last copy of the returned pointer is gone.
  std::shared_ptr<const void> Count(const Size& frame) {
    sum_->frames += frame.frames;
    sum_->tiles += frame.tiles;
    sum_->bytes += frame.bytes;
    return {sum_.get(), [sum = sum_, frame](const void*) {
              sum->frames -= frame.frames;
              sum->tiles -= frame.tiles;
              sum->bytes -= frame.bytes;
            }};
  }

 private:
  std::shared_ptr<Size> sum_ = std::make_shared<Size>();
};

}  // namespace tessera
