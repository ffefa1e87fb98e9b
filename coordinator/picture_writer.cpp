#include "coordinator/picture_writer.h"

#include "coordinator/guarded.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

// A full disk empties slowly.
constexpr std::chrono::milliseconds kRetryInterval{2000};

Result<Digest> EncodeAndStore(const FinishedPicture& picture, PictureStore& store) {
  const auto bytes = EncodePicture(picture);
  if (!bytes) return bytes.error();
  if (const auto written = store.Write(picture.job, picture.frame, *bytes); !written) return written.error();
  return Sha256(*bytes);
}

}  // namespace

Result<std::string> EncodePicture(const FinishedPicture& picture) {
  return GuardedResult(
      [&] { return EncodeExr(picture.spec->frames[picture.frame].spec, picture.snapshot.Picture()); });
}

Result<std::string> EncodePreview(const FinishedPicture& picture) {
  return GuardedResult([&] {
    const FrameSnapshot::Preview preview = picture.snapshot.MakePreview(kPreviewValuesMax);
    return EncodeExr(preview.spec, preview.picture);
  });
}

void PictureWriter::Write(FinishedPicture picture, OnWritten report) {
  const auto shared = std::make_shared<const FinishedPicture>(std::move(picture));
  thread_.Post([this, shared, report = std::move(report)] { Attempt(shared, report); });
}

void PictureWriter::Remove(JobId job) {
  thread_.Post([this, job] { store_.Remove(job); });
}

void PictureWriter::Attempt(const std::shared_ptr<const FinishedPicture>& picture, const OnWritten& report) {
  const auto start = std::chrono::steady_clock::now();
  const auto file = EncodeAndStore(*picture, store_);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (file) return report(WrittenPicture{*file, seconds});
  report(file.error());
  // Others go first: a removal may be what makes room.
  if (thread_.Sleep(kRetryInterval)) thread_.Post([=, this] { Attempt(picture, report); });
}

}  // namespace tessera
