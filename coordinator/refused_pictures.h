// Denoised pictures that the store refused, usually because the disk is full. They are kept in memory, as far
// as a limit of bytes allows, so that the next attempt to write them does not denoise again. Not thread safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "coordinator/core/spool.h"
#include "proto/terms.h"
#include "renderer/denoise/finished_picture.h"

namespace tessera {

class RefusedPictures {
 public:
  using Clock = std::chrono::steady_clock;
  // What nobody has asked for meanwhile is of a job that has ended.
  static constexpr Clock::duration kAbandonedAfter = std::chrono::minutes(5);

  explicit RefusedPictures(uint64_t bytes_max) : bytes_max_(bytes_max) {}

  // Removes and returns the picture of the frame. Returns nullopt if there is none, or if it was made by
  // another specification: before its job was extended.
  std::optional<EncodedPicture> Take(FrameId frame, const std::shared_ptr<const JobSpec>& spec);
  // Discards the picture if there is no room. While no other is kept, it may be larger than the limit.
  void Keep(FrameId frame, std::shared_ptr<const JobSpec> spec, EncodedPicture picture,
            Clock::time_point now);
  void Remove(JobId job);
  uint64_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::shared_ptr<const JobSpec> spec;
    EncodedPicture picture;
    Clock::time_point since;
  };
  template <typename Predicate>
  void RemoveIf(const Predicate& is_unwanted);

  const uint64_t bytes_max_;
  uint64_t bytes_ = 0;  // of all pictures
  std::map<FrameId, Kept> kept_;
};

}  // namespace tessera
