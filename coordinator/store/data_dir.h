// The folder in which a coordinator keeps everything that outlives it. Held by one process at a time.
//   version    "tessera-data 3"
//   lock       locked while a coordinator runs
//   journal    facts (file_journal.h)
//   blobs/     scene files by digest (blob_store.h)
//   pictures/  JOB/FRAME.exr: finished frames
//   spool/     results of frames that are rendered, sums of those that may be extended (file_spool.h)
#pragma once

#include <string>

#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

class DataDir {
 public:
  // Makes the folder if there is none, locks it, and removes what a crash left half-written. An error if
  // another process holds it or its version is another.
  static Result<DataDir> Open(const std::string& path);
  ~DataDir();
  DataDir(DataDir&& other) noexcept;
  DataDir& operator=(DataDir&&) = delete;

  std::string JournalPath() const { return path_ + "/journal"; }
  std::string SpoolPath() const { return path_ + "/spool"; }
  std::string BlobsPath() const { return path_ + "/blobs"; }
  std::string PicturePath(JobId job, uint32_t frame) const;
  // Makes the folder that PicturePath is in.
  Result<void> PreparePicture(JobId job) const;
  // Of a job that is forgotten.
  void RemovePictures(JobId job) const;

 private:
  DataDir(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_;
};

}  // namespace tessera
