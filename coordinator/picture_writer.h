// Paints, encodes and stores the pictures of finished frames on a thread of its own, so that the core thread
// only hands out snapshots.
#pragma once

#include <functional>
#include <memory>

#include "coordinator/background_thread.h"
#include "coordinator/core/farm.h"
#include "coordinator/store/picture_store.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

struct WrittenPicture {
  Digest file;         // of its bytes
  double seconds = 0;  // painting, encoding and storing took
};

// The bytes of an EXR file.
Result<std::string> EncodePicture(const FinishedPicture& picture);
// The same of a frame that is not finished. More than kPreviewValuesMax values are reduced to every second,
// third,
// ... pixel, so that a preview takes a bounded amount of memory.
Result<std::string> EncodePreview(const FinishedPicture& picture);
// 3840 x 2160 pixels in colour.
constexpr int64_t kPreviewValuesMax = 25'000'000;

// Thread safe.
class PictureWriter {
 public:
  // The store must outlive the writer.
  explicit PictureWriter(PictureStore& store) : store_(store) {}

  // Called on the writer's thread: with an error after each failed attempt, then once with the written
  // picture.
  using OnWritten = std::function<void(Result<WrittenPicture>)>;
  // Returns immediately. A picture that the store refuses is tried again every few seconds, after everything
  // else that waits. If Stop comes first, it is given up: the sums of the frame are still in the spool.
  void Write(FinishedPicture picture, OnWritten report);
  // Removes the pictures of a job. Returns immediately.
  void Remove(JobId job);
  // Attempts once what waits, then ends the thread.
  void Stop() { thread_.Stop(); }

 private:
  void Attempt(const std::shared_ptr<const FinishedPicture>& picture, const OnWritten& report);

  PictureStore& store_;
  BackgroundThread thread_;
};

}  // namespace tessera
