#include "coordinator/picture_writer.h"

#include "coordinator/guarded.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

Result<WrittenPicture> EncodeAndStore(const FinishedPicture& picture, PictureStore& store) {
  const auto start = std::chrono::steady_clock::now();
  const auto bytes = EncodePicture(picture);
  if (!bytes) return bytes.error();
  if (const auto written = store.Write(picture.job, picture.frame, *bytes); !written) return written.error();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return WrittenPicture{{Sha256(*bytes), bytes->size()}, seconds};
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
  auto shared = std::make_shared<FinishedPicture>(std::move(picture));
  thread_.Post([this, shared = std::move(shared), report = std::move(report)] {
    auto written = EncodeAndStore(*shared, store_);
    *shared = {};
    report(std::move(written));
  });
}

void PictureWriter::Remove(JobId job) {
  thread_.Post([this, job] { store_.Remove(job); });
}

}  // namespace tessera
