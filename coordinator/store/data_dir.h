// The folder in which a coordinator keeps everything that outlives it. One process at a time holds it, and
// only its user may look into it.
//   version    names the format; older ones that can be read are brought up to date when they are opened
//   lock       locked while a coordinator runs, as the folder itself is
//   journal    facts (file_journal.h)
//   blobs/     scene files by digest (blob_store.h)
//   pictures/  finished frames (file_pictures.h)
//   messages   what people are told about jobs (message_file.h)
//   identity/  keys and certificates (farm_identity.h)
//   spool/     results of unfinished frames and kept sums of finished ones (file_spool.h)
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "renderer/util/readable_file.h"
#include "renderer/util/result.h"

namespace tessera {

class DataDir {
 public:
  enum class Journal {
    kRequired,   // a folder that was used before must have one
    kMayBeGone,  // all jobs of former processes are forgotten if it is
  };
  // Creates the folder if there is none, locks it and removes files that a crash left half-written. An error
  // if another process still holds the folder after two seconds, if it has another version, or if its journal
  // is missing.
  static Result<DataDir> Open(const std::string& path, Journal journal = Journal::kRequired);
  ~DataDir();
  DataDir(DataDir&& other) noexcept;
  DataDir& operator=(DataDir&&) = delete;

  // Whether the folder has not been brought up to date yet.
  bool is_older() const;
  // Call this once there is a journal and the folder is up to date: from now on it must have a journal.
  Result<void> MarkUsed() const;
  // An error that names the file system if `bytes` more would hardly fit on it.
  Result<void> CheckSpace(uint64_t bytes) const;
  // Keeps bytes that are being sent to somebody in a file without a name: a slow reader takes no memory. An
  // error if the disk would not be left enough for the journal and for results.
  Result<ReadableFile> KeepForSending(std::string_view bytes) const;

  std::string JournalPath() const { return path_ + "/journal"; }
  std::string SpoolPath() const { return path_ + "/spool"; }
  std::string BlobsPath() const { return path_ + "/blobs"; }
  std::string PicturesPath() const { return path_ + "/pictures"; }
  std::string MessagesPath() const { return path_ + "/messages"; }
  std::string IdentityPath() const { return path_ + "/identity"; }

 private:
  explicit DataDir(std::string path) : path_(std::move(path)) {}
  Result<void> Lock();
  std::string path_;
  int folder_ = -1, lock_ = -1;  // both locked
};

}  // namespace tessera
