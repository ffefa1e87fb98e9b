// The folder in which a coordinator keeps everything that outlives it. Held by one process at a time.
//   version    "tessera-data 1"
//   lock       locked while a coordinator runs
//   journal    facts (file_journal.h)
//   blobs/     scene files by digest (blob_store.h)
//   pictures/  JOB/FRAME.exr: finished frames
#pragma once

#include <string>

#include "terms/terms.h"
#include "util/result.h"

namespace tessera {

class DataDir {
 public:
  // Makes the folder if there is none, and locks it. An error if another process holds it or its version is
  // unknown.
  static Result<DataDir> Open(const std::string& path);
  ~DataDir();
  DataDir(DataDir&& other) noexcept;
  DataDir& operator=(DataDir&&) = delete;

  std::string JournalPath() const { return path_ + "/journal"; }
  std::string BlobsPath() const { return path_ + "/blobs"; }
  std::string PicturePath(JobId job, uint32_t frame) const;
  // Makes the folder that PicturePath is in.
  Result<void> PreparePicture(JobId job) const;

 private:
  DataDir(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_;
};

}  // namespace tessera
