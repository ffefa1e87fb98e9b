// Scene files on this machine's disk, by digest, so that a file is fetched once and not once per job.
//
// FOLDER/xx/DIGEST holds the bytes whose SHA-256 is DIGEST (xx: its first two digits). Files are written
// beside and renamed, verified on write and on every read, so several processes may share a folder and
// nothing needs syncing: what a crash damaged is found and fetched again.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

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

  // Whether a file of that digest and size is here; its bytes are checked when they are read.
  bool Has(const Digest& digest, uint64_t size) const;
  // The largest blob that is worth keeping.
  uint64_t bytes_max() const { return bytes_max_; }

  // A blob on its way into the cache, piece by piece, never whole in memory. What came of one that is broken
  // off stays on disk, also for the next process. One thread at a time.
  class Incoming {
   public:
    ~Incoming();
    Incoming(const Incoming&) = delete;
    Incoming& operator=(const Incoming&) = delete;
    uint64_t size() const { return size_; }  // so far
    Result<void> Add(std::string_view bytes);
    // Puts it at its name. An error if the bytes are not the digest's: then nothing of them stays.
    Result<void> Finish();

   private:
    friend class BlobCache;
    Incoming() = default;
    int file_ = -1;
    std::string beside_, path_;
    Digest digest_;
    uint64_t size_ = 0;
    Sha256Stream hash_;
  };
  // Null while another thread or process is fetching the same blob. Makes room for `size` bytes.
  Result<std::unique_ptr<Incoming>> Begin(const Digest& digest, uint64_t size);

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
