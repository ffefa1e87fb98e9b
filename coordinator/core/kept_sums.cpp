#include "coordinator/core/kept_sums.h"

namespace tessera {

std::vector<FrameId> KeptSums::Add(FrameId frame, uint64_t bytes) {
  Remove(frame);
  places_[frame] = kept_.insert(kept_.end(), {frame, bytes});
  bytes_ += bytes;
  std::vector<FrameId> gone;
  while (bytes_ > bytes_max_) {
    gone.push_back(kept_.front().frame);
    Remove(kept_.front().frame);
  }
  return gone;
}

bool KeptSums::Remove(FrameId frame) {
  const auto found = places_.find(frame);
  if (found == places_.end()) return false;
  bytes_ -= found->second->bytes;
  kept_.erase(found->second);
  places_.erase(found);
  return true;
}

std::vector<FrameId> KeptSums::Frames() const {
  std::vector<FrameId> all;
  for (const Kept& each : kept_) all.push_back(each.frame);
  return all;
}

}  // namespace tessera
