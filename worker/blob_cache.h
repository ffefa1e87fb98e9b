// Scene files on this machine's disk, by digest, so that a file is fetched once and not once per job.
//
// FOLDER/xx/DIGEST holds the bytes whose SHA-256 is DIGEST (xx: its first two digits). Files are written
// beside and renamed, verified on write and on every read, so several processes may share a folder and
// nothing needs syncing: what a crash damaged is found and fetched again.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "util/digest.h"
#include "util/result.h"

namespace tessera {

// Thread safe.
class BlobCache {
 public:
  // Makes the folder if it is not there. At most `bytes_max` are kept, the longest unused given up first.
  static Result<void> Prepare(const std::string& folder);
  BlobCache(std::string folder, uint64_t bytes_max);

  // The bytes, if they are here and whole.
  std::optional<std::string> Get(const Digest& digest);
  // Keeps the bytes, whose digest the caller has checked. A failure costs a download later and nothing else.
  Result<void> Put(const Digest& digest, std::string_view bytes);

 private:
  std::string PathOf(const Digest& digest) const;
  void MakeRoomFor(uint64_t bytes);

  const std::string folder_;
  const uint64_t bytes_max_;
  std::atomic<uint64_t> written_ = 0;      // names of temporary files
  std::atomic<uint64_t> bytes_;            // estimate: other processes write too; corrected when it matters
  std::atomic<bool> making_room_ = false;  // one thread does it at a time, the others need not
};

}  // namespace tessera
