#include "client/live/local_pictures.h"

#include <chrono>
#include <utility>

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kOfferPatience{300};  // the renderer offers several a second

}  // namespace

void PictureHandoff::Offer(int frame, const TakeSnapshot& take) {
  {
    const std::lock_guard lock(mutex_);
    if (!is_wanted_) return;
  }
  auto snapshot = take();
  const std::lock_guard lock(mutex_);
  is_wanted_ = false;
  work_ = Work{frame, std::move(snapshot), {}};
  changed_.notify_all();
}

void PictureHandoff::Finish(int frame, std::string exr) {
  const std::lock_guard lock(mutex_);
  is_wanted_ = false;
  work_ = Work{frame, std::nullopt, std::move(exr)};
  changed_.notify_all();
}

std::optional<PictureHandoff::Work> PictureHandoff::Take(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  is_wanted_ = !work_;
  changed_.wait_for(lock, stop, kOfferPatience, [this] { return work_.has_value(); });
  is_wanted_ = false;
  return std::exchange(work_, std::nullopt);
}

Result<std::optional<LivePicture>> LocalPictures::Next(const std::stop_token& stop) {
  auto work = handoff_->Take(stop);
  if (!work) return std::optional<LivePicture>();
  if (work->snapshot) {
    const FrameSnapshot snapshot = *std::exchange(work->snapshot, std::nullopt);
    auto exr = EncodeExr(snapshot.spec(), snapshot.Picture());
    if (!exr) return exr.error();
    work->exr = std::move(*exr);
  }
  auto picture = DecodeExr(work->exr, "the picture");
  if (!picture) return picture.error();
  return std::optional(LivePicture{work->frame, std::move(*picture)});
}

}  // namespace tessera
