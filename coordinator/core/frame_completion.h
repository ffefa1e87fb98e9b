// Frames from their last sample to their file, and the sums that stay in the spool so that finished frames
// can be extended and damaged files made again. Owned by the farm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/job_end.h"
#include "coordinator/core/picture_queue.h"

namespace tessera {

class FrameCompletion {
 public:
  FrameCompletion(FarmState& state, JobEnd& end) : state_(state), end_(end) {}

  // The merger of an active frame. Sums of it that are in the spool alone are requested.
  Merger& MergerOf(Job& job, uint32_t frame);
  // All samples of the frame are merged: its picture is to be written.
  void Complete(Job& job, uint32_t frame);
  void PictureWritten(Instant now, FrameId frame, const PictureFile& file);
  // An attempt to write the picture failed: shows the reason and tries again later.
  void PictureDelayed(Instant now, FrameId frame, const std::string& reason);
  // The picture that PictureWritten names next is noisy, although its frame is to be denoised.
  void PictureNotDenoised(FrameId frame, const std::string& reason);
  // The file of a finished frame is damaged or missing. Returns whether it is made again from its sums; if
  // these are gone, the job shows that the picture is lost.
  bool PictureDamaged(FrameId frame, const std::string& reason);
  // The file of a finished frame was read and is as it was written.
  void PictureIntact(FrameId frame);
  // What is there of a frame that is being rendered; nullopt if it is complete, its job has ended or there is
  // no such frame.
  std::optional<FinishedPicture> Preview(JobId job, uint32_t frame) const;

  // All nodes of a frame that is being rendered. Returns nullopt if it is not, or if some are in the spool
  // alone.
  std::optional<std::vector<TileNode>> Sums(FrameId frame) const;
  void SumsLoaded(Instant now, FrameId frame, Result<std::vector<TileNode>> nodes);
  // Keeps the sums of a finished frame, as far as the limit of bytes allows.
  void KeepSums(const Job& job, uint32_t frame);
  bool MayKeepSums() const { return state_.kept_sums.keeps_any(); }

  // Requests the sums of pictures that are due.
  void Advance(Instant now);
  std::optional<Instant> next_due() const { return pictures_.next_due(); }

 private:
  void ContinueFrame(Instant now, Job& job, uint32_t frame, Result<std::vector<TileNode>> nodes);
  void MakePicture(Instant now, Job& job, uint32_t frame, Result<std::vector<TileNode>> nodes);
  void Remade(Job& job, uint32_t frame, const PictureFile& file);
  void Lose(Job& job, uint32_t frame, const std::string& reason);
  void Log(std::string line) { state_.output.log.push_back(std::move(line)); }

  FarmState& state_;
  JobEnd& end_;
  PictureQueue pictures_;
};

}  // namespace tessera
