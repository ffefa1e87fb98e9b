#include "client/live/farm_pictures.h"

#include <fmt/format.h>

#include <algorithm>

#include "client/temporary_folder.h"

namespace tessera {

Result<std::optional<LivePicture>> FarmPictures::Next(const std::stop_token& stop) {
  if (client_ == nullptr) {
    auto connected = CoordinatorClient::Connect(endpoint_, Patience{}, stop);
    if (!connected) return connected.error();
    client_ = std::move(*connected);
  }
  const auto status = client_->Status(job_);
  if (!status) return status.error();
  const State now{status->samples_done, status->frames_finished};
  if (now == shown_) return std::optional<LivePicture>();
  const auto frames = client_->Frames(job_);
  if (!frames) return frames.error();
  const auto is_open = [](const FrameStatus& frame) { return !frame.file && !frame.has_failed; };
  const auto open = std::ranges::find_if(*frames, is_open);
  const auto index = std::min(static_cast<size_t>(open - frames->begin()), frames->size() - 1);
  auto fetched = client_->FetchPicture(job_, static_cast<uint32_t>(index), true, TemporaryRoot());
  // The coordinator has nothing of this frame yet.
  if (!fetched && fetched.error().kind == ErrorKind::kBadInput) return std::optional<LivePicture>();
  if (!fetched) return fetched.error();
  const auto exr = fetched->Bytes();
  if (!exr) return exr.error();
  auto picture = DecodeExr(*exr, fmt::format("the picture of job {}", Number(job_)));
  if (!picture) return picture.error();
  shown_ = now;
  return std::optional(LivePicture{(*frames)[index].number, std::move(*picture)});
}

}  // namespace tessera
