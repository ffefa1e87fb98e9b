// Paints, denoises, encodes and stores the pictures of finished frames on threads of its own, so that the
// core thread only hands out snapshots. Pictures that are to be denoised, which takes seconds, have a thread
// for themselves, so that the others do not wait for it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "coordinator/core/farm.h"
#include "coordinator/refused_pictures.h"
#include "coordinator/store/picture_store.h"
#include "coordinator/task_pool.h"
#include "renderer/util/result.h"

namespace tessera {

struct WrittenPicture {
  PictureFile file;
  double seconds = 0;          // painting, denoising, encoding and storing took
  std::string denoise_failed;  // why it is noisy although its frame is to be denoised; or empty
};

// The bytes of an EXR file of a frame that is not finished, of at most kPreviewValuesMax values.
Result<std::string> EncodePreview(const FinishedPicture& picture);

// Of denoised pictures that could not be written, which are not denoised again: some of 1920 x 1080 pixels.
constexpr uint64_t kRefusedBytesMax = uint64_t{256} << 20;

// Thread safe.
class PictureWriter {
 public:
  // The store must outlive the writer.
  explicit PictureWriter(PictureStore& store, uint64_t refused_bytes_max = kRefusedBytesMax);

  // Called once, on a thread of the writer.
  using OnWritten = std::function<void(Result<WrittenPicture>)>;
  // Returns immediately. The snapshot is freed before `report` is called.
  void Write(FinishedPicture picture, OnWritten report);
  // Removes the pictures of a job. Returns immediately.
  void Remove(JobId job);
  // Writes what waits, then ends the threads. What is to be denoised is given up with an error: the next
  // start makes it again.
  void Stop();

 private:
  Result<WrittenPicture> EncodeAndStore(FinishedPicture picture);

  PictureStore& store_;
  std::stop_source stop_;    // denoising
  RefusedPictures refused_;  // used by the thread of denoising_ alone
  TaskPool plain_{1};
  TaskPool denoising_{1};
};

}  // namespace tessera
