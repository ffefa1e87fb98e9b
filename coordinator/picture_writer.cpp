#include "coordinator/picture_writer.h"

#include <sys/resource.h>

#include <chrono>
#include <optional>
#include <utility>

#include "coordinator/core/preview_limit.h"
#include "coordinator/guarded.h"
#include "renderer/denoise/finished_picture.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/cores.h"

namespace tessera {
namespace {

// Denoising takes all cores, but has a third of the weight of what the coordinator does for others.
constexpr int kDenoiseNiceness = 5;

// An unfinished frame is not denoised.
bool IsDenoised(const FinishedPicture& picture) {
  return picture.is_complete && picture.spec->frames[picture.frame].spec.denoiser != Denoiser::kNone;
}

Result<EncodedPicture> Encode(FinishedPicture& picture, const std::stop_token& stop) {
  return GuardedResult([&] {
    FrameSpec spec = picture.spec->frames[picture.frame].spec;
    if (!picture.is_complete) spec.denoiser = Denoiser::kNone;
    FramePicture painted = picture.snapshot.Picture();
    picture.snapshot = {};  // frees the sums
    return EncodeFinished(spec, std::move(painted), UsableCores(), stop);
  });
}

}  // namespace

Result<std::string> EncodePreview(const FinishedPicture& picture) {
  return GuardedResult([&] {
    const FrameSnapshot::Preview preview = picture.snapshot.MakePreview(kPreviewValuesMax);
    return EncodeExr(preview.spec, preview.picture);
  });
}

PictureWriter::PictureWriter(PictureStore& store, uint64_t refused_bytes_max)
    : store_(store), refused_(refused_bytes_max) {
  // Of this thread and of those that it starts. If it fails, the others just wait a little longer.
  denoising_.Post([] { ::setpriority(PRIO_PROCESS, 0, kDenoiseNiceness); });
}

void PictureWriter::Write(FinishedPicture picture, OnWritten report) {
  TaskPool& pool = IsDenoised(picture) ? denoising_ : plain_;
  auto shared = std::make_shared<FinishedPicture>(std::move(picture));
  pool.Post([this, shared = std::move(shared), report = std::move(report)] {
    report(EncodeAndStore(std::move(*shared)));
  });
}

Result<WrittenPicture> PictureWriter::EncodeAndStore(FinishedPicture picture) {
  const auto start = std::chrono::steady_clock::now();
  const FrameId frame{picture.job, picture.frame};
  const bool is_denoised = IsDenoised(picture);
  std::optional<EncodedPicture> encoded;
  if (is_denoised) encoded = refused_.Take(frame, picture.spec);
  if (!encoded) {
    auto made = Encode(picture, stop_.get_token());
    if (!made) return made.error();
    encoded = std::move(made).value();
  }
  picture.snapshot = {};
  if (const auto written = store_.Write(frame.job, frame.frame, encoded->exr); !written) {
    if (is_denoised)
      refused_.Keep(frame, picture.spec, std::move(*encoded), std::chrono::steady_clock::now());
    return written.error();
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return WrittenPicture{{Sha256(encoded->exr), encoded->exr.size()}, seconds, encoded->denoise_failed};
}

// After what waits of the job on either thread.
void PictureWriter::Remove(JobId job) {
  denoising_.Post([this, job] {
    refused_.Remove(job);
    plain_.Post([this, job] { store_.Remove(job); });
  });
}

void PictureWriter::Stop() {
  stop_.request_stop();
  denoising_.Stop();
  plain_.Stop();
}

}  // namespace tessera
