// Paints, encodes and stores the pictures of finished frames on a thread of its own, so that the core thread
// only hands out snapshots.
#pragma once

#include <functional>
#include <memory>

#include "coordinator/core/farm.h"
#include "coordinator/store/picture_store.h"
#include "coordinator/task_pool.h"
#include "renderer/util/result.h"

namespace tessera {

struct WrittenPicture {
  PictureFile file;
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

  // Called once, on the writer's thread.
  using OnWritten = std::function<void(Result<WrittenPicture>)>;
  // Returns immediately. The snapshot is freed before `report` is called.
  void Write(FinishedPicture picture, OnWritten report);
  // Removes the pictures of a job. Returns immediately.
  void Remove(JobId job);
  // Writes what waits, then ends the thread.
  void Stop() { thread_.Stop(); }

 private:
  PictureStore& store_;
  TaskPool thread_{1};
};

}  // namespace tessera
