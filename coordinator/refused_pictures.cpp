#include "coordinator/refused_pictures.h"

#include <utility>

namespace tessera {

template <typename Predicate>
void RefusedPictures::RemoveIf(const Predicate& is_unwanted) {
  std::erase_if(kept_, [&](const auto& each) {
    const bool is_removed = is_unwanted(each.first, each.second);
    if (is_removed) bytes_ -= each.second.picture.exr.size();
    return is_removed;
  });
}

std::optional<EncodedPicture> RefusedPictures::Take(FrameId frame,
                                                    const std::shared_ptr<const JobSpec>& spec) {
  auto found = kept_.extract(frame);
  if (found.empty()) return std::nullopt;
  bytes_ -= found.mapped().picture.exr.size();
  if (found.mapped().spec != spec) return std::nullopt;
  return std::move(found.mapped().picture);
}

void RefusedPictures::Keep(FrameId frame, std::shared_ptr<const JobSpec> spec, EncodedPicture picture,
                           Clock::time_point now) {
  RemoveIf([&](FrameId id, const Kept& kept) { return id == frame || now - kept.since > kAbandonedAfter; });
  const uint64_t bytes = picture.exr.size();
  if (!kept_.empty() && bytes_ + bytes > bytes_max_) return;
  bytes_ += bytes;
  kept_.emplace(frame, Kept{std::move(spec), std::move(picture), now});
}

void RefusedPictures::Remove(JobId job) {
  RemoveIf([job](FrameId id, const Kept&) { return id.job == job; });
}

}  // namespace tessera
