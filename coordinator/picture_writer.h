// Writes finished frames into the data directory, on a thread of its own, again and again until the disk
// takes them.
#pragma once

#include "coordinator/background_thread.h"
#include "coordinator/core/farm.h"
#include "coordinator/store/data_dir.h"

namespace tessera {

class CoreThread;

class PictureWriter {
 public:
  explicit PictureWriter(const DataDir& directory) : directory_(directory) {}
  // Thread safe; returns at once. The farm is told of the outcome through `core`.
  void Write(CoreThread& core, FinishedPicture picture);
  void Stop() { thread_.Stop(); }

 private:
  void WriteNow(CoreThread& core, const FinishedPicture& picture);
  const DataDir& directory_;
  BackgroundThread thread_;
};

}  // namespace tessera
