// Frames from their last sample to their file, and the sums that stay in the spool so that finished frames
// can be extended. Owned by the farm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/job_end.h"

namespace tessera {

class FrameCompletion {
 public:
  FrameCompletion(FarmState& state, JobEnd& end) : state_(state), end_(end) {}

  // The merger of an active frame. Sums of it that are in the spool alone are requested.
  Merger& MergerOf(Job& job, uint32_t frame);
  // All samples of the frame are merged: its picture is to be written.
  void Complete(Job& job, uint32_t frame);
  void PictureWritten(Instant now, JobId job, uint32_t frame, const Digest& file);
  // Shows the reason as that of a pause; the caller tries again.
  void PictureDelayed(JobId job, const std::string& reason);
  // What is there of a frame that is being rendered; nullopt if it is complete, its job has ended or there is
  // no such frame.
  std::optional<FinishedPicture> Preview(JobId job, uint32_t frame) const;

  // All nodes of a frame that is being rendered. Returns nullopt if it is not, or if some are in the spool
  // alone.
  std::optional<std::vector<TileNode>> Sums(FrameId frame) const;
  void SumsLoaded(Instant now, FrameId frame, Result<std::vector<TileNode>> nodes);
  // Keeps the sums of a finished frame, as far as the limit of bytes allows.
  void KeepSums(const Job& job, uint32_t frame);
  bool MayKeepSums(const Job& job) const;

 private:
  FarmState& state_;
  JobEnd& end_;
};

}  // namespace tessera
