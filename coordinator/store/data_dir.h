// The folder in which a coordinator keeps everything that outlives it. One process at a time holds it.
//   version    "tessera-data 5"; a directory of version 4 is read and becomes one of version 5 when it is
//   opened lock       locked while a coordinator runs journal    facts (file_journal.h) blobs/     scene
//   files by digest (blob_store.h) pictures/  finished frames (file_pictures.h) spool/     results of
//   unfinished frames and kept sums of finished ones (file_spool.h)
#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

class DataDir {
 public:
  // Creates the folder if there is none, locks it and removes files that a crash left half-written. An error
  // if another process holds the folder or if it has another version.
  static Result<DataDir> Open(const std::string& path);
  ~DataDir();
  DataDir(DataDir&& other) noexcept;
  DataDir& operator=(DataDir&&) = delete;

  std::string JournalPath() const { return path_ + "/journal"; }
  std::string SpoolPath() const { return path_ + "/spool"; }
  std::string BlobsPath() const { return path_ + "/blobs"; }
  std::string PicturesPath() const { return path_ + "/pictures"; }

 private:
  DataDir(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_;
};

}  // namespace tessera
