#include "coordinator/core/picture_queue.h"

namespace tessera {

bool PictureQueue::Hold(FrameId frame, uint64_t bytes) {
  if (!HasRoomFor(bytes) || !held_.emplace(frame, bytes).second) return false;
  held_bytes_ += bytes;
  return true;
}

void PictureQueue::Release(FrameId frame) {
  const auto found = held_.find(frame);
  if (found == held_.end()) return;
  held_bytes_ -= found->second;
  held_.erase(found);
}

void PictureQueue::Wait(FrameId frame, uint64_t bytes, Instant due) {
  waiting_[{due, frame}] = bytes;
}

std::optional<FrameId> PictureQueue::TakeDue(Instant now) {
  const auto due = next_due();
  if (!due || *due > now) return std::nullopt;
  const auto first = waiting_.begin();
  const FrameId frame = first->first.second;
  const uint64_t bytes = first->second;
  waiting_.erase(first);
  Hold(frame, bytes);
  return frame;
}

std::optional<Instant> PictureQueue::next_due() const {
  if (waiting_.empty() || !HasRoomFor(waiting_.begin()->second)) return std::nullopt;
  return waiting_.begin()->first.first;
}

}  // namespace tessera
