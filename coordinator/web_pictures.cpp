#include "coordinator/web_pictures.h"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <utility>

#include "coordinator/ask_core.h"
#include "coordinator/core/guarded_result.h"

namespace tessera {
namespace {

WebError NothingRendered(FrameId id) {
  return {409, fmt::format("nothing was rendered of frame {} of job {}", id.frame, Number(id.job))};
}

}  // namespace

WebResult<FrameState> WebPictures::Frame(JobId job, uint32_t frame) const {
  using Clock = std::chrono::steady_clock;
  auto state = AskCore(core_, [job, frame](CoreContext& context) -> std::optional<FrameState> {
    const auto start = Clock::now();
    const auto status = context.farm.Status(context.now, job);
    if (!status || frame >= status->frames_total) return std::nullopt;
    FrameState found{*status, context.farm.Spec(job), {}, context.farm.FinishedFile(job, frame), {}};
    found.has_failed = context.farm.HasFailed({job, frame});
    if (!found.file) {
      if (auto preview = context.farm.Preview(job, frame)) found.snapshot = std::move(preview->snapshot);
    }
    found.cost = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    return found;
  });
  if (!state) return WebError{503, "the coordinator is busy"};
  if (!*state) return WebError{404, fmt::format("there is no frame {} of job {}", frame, Number(job))};
  return std::move(**state);
}

// What was damaged since it was written is not shown. It is made again if that is possible. A picture that
// cannot be read for lack of memory or descriptors may be intact.
template <typename Picture>
WebResult<Picture> WebPictures::Checked(FrameId id, bool is_finished,
                                        const std::function<Result<Picture>()>& read) const {
  try {
    auto picture = read();
    if (picture) {
      if (is_finished) core_.Post([id](CoreContext& context) { context.farm.PictureIntact(id); });
      return std::move(*picture);
    }
    const auto& [kind, reason] = picture.error();
    if (kind == ErrorKind::kInterrupted) return WebError{503, reason};
    if (!is_finished) return NothingRendered(id);
    core_.Post([id, why = reason](CoreContext& context) { context.farm.PictureDamaged(id, why); });
    return WebError{503, reason + "; it is made again if that is possible"};
  } catch (const std::exception& e) {
    return WebError{503, ReasonOf(e)};
  }
}

WebResult<std::string> WebPictures::Read(JobId job, uint32_t frame,
                                         const std::optional<PictureFile>& file) const {
  return Checked<std::string>({job, frame}, file.has_value(), [&] {
    return file ? pictures_.Read(job, frame, *file) : pictures_.ReadPartial(job, frame);
  });
}

WebResult<ReadableFile> WebPictures::Open(JobId job, uint32_t frame,
                                          const std::optional<PictureFile>& file) const {
  return Checked<ReadableFile>({job, frame}, file.has_value(), [&]() -> Result<ReadableFile> {
    auto picture = pictures_.Open(job, frame, file);
    if (!picture) return picture.error();
    return std::move(picture->file);
  });
}

}  // namespace tessera
