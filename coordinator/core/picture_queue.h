// Finished pictures on their way to files: which of them have their sums in memory, and which wait to be made
// from the sums in the spool, because too many others are in memory, because an attempt to write them failed,
// or because their file was damaged. Pure bookkeeping. Owned by FrameCompletion.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "coordinator/core/schedule/instant.h"
#include "coordinator/core/spool.h"

namespace tessera {

// Of the sums of finished pictures in memory: some frames of 1920 x 1080 pixels, so that the next one is
// there when one is written. A single picture may be larger.
constexpr uint64_t kPictureMemoryBytesMax = uint64_t{256} << 20;

class PictureQueue {
 public:
  explicit PictureQueue(uint64_t memory_bytes_max = kPictureMemoryBytesMax)
      : memory_bytes_max_(memory_bytes_max) {}

  // The sums of the frame are in memory until Release. Returns false, and changes nothing, if there is no
  // room.
  bool Hold(FrameId frame, uint64_t bytes);
  // Does nothing if the frame is not held.
  void Release(FrameId frame);
  // The frame is to be loaded from `due` on, when there is room. It must not be waiting.
  void Wait(FrameId frame, uint64_t bytes, Instant due);
  // The first frame that is due, if there is room for it. It is held from now on.
  std::optional<FrameId> TakeDue(Instant now);
  // When TakeDue may return a frame; nullopt if none waits or if there is no room for it.
  std::optional<Instant> next_due() const;
  uint64_t held_bytes() const { return held_bytes_; }

 private:
  bool HasRoomFor(uint64_t bytes) const { return held_.empty() || held_bytes_ + bytes <= memory_bytes_max_; }
  const uint64_t memory_bytes_max_;
  uint64_t held_bytes_ = 0;
  std::map<FrameId, uint64_t> held_;                         // bytes of each
  std::map<std::pair<Instant, FrameId>, uint64_t> waiting_;  // bytes of each, by when it is due
};

}  // namespace tessera
