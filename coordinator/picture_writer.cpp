#include "coordinator/picture_writer.h"

#include "coordinator/core_thread.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kRetry{2000};  // a full disk empties slowly

Result<Digest> EncodeAndWrite(const DataDir& directory, const FinishedPicture& finished) {
  const auto bytes = EncodeExr(finished.spec->frames[finished.frame].spec, finished.snapshot.Picture());
  if (!bytes) return bytes.error();
  if (const auto prepared = directory.PreparePicture(finished.job); !prepared) return prepared.error();
  const auto written = WriteFileAtomically(directory.PicturePath(finished.job, finished.frame), *bytes);
  if (!written) return written.error();
  return Sha256(*bytes);
}

}  // namespace

void PictureWriter::Write(CoreThread& core, FinishedPicture picture) {
  const auto shared = std::make_shared<const FinishedPicture>(std::move(picture));
  thread_.Post([this, &core, shared] { WriteNow(core, *shared); });
}

void PictureWriter::WriteNow(CoreThread& core, const FinishedPicture& picture) {
  const JobId job = picture.job;
  const uint32_t frame = picture.frame;
  while (true) {
    const auto begun = std::chrono::steady_clock::now();
    const auto written = EncodeAndWrite(directory_, picture);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    if (written) {
      core.Post([=](CoreContext& context) {
        context.farm.counters().picture_s += seconds;
        context.farm.PictureWritten(context.now, job, frame, *written);
      });
      return;
    }
    const std::string reason = written.error().message;
    core.Post([=](CoreContext& context) { context.farm.PictureDelayed(job, reason); });
    if (!thread_.Sleep(kRetry)) return;  // the process ends; the next one has the frame in its spool
  }
}

}  // namespace tessera
