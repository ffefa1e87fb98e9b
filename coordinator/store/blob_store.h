// Scene files by their digest. A blob is at its name whole and right, or not at all. Bounded: when there is
// no room, those that have not been used for longest go, but never one that an open job needs or that was
// used a moment ago, since a client may be about to submit a job with it. A blob's time of modification is
// its last use, so restarts forget nothing. Thread safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// Some hundred large scenes; few disks of servers are smaller.
constexpr uint64_t kBlobBytesDefault = uint64_t{100} << 30;
constexpr uint64_t kBlobBytesMin = uint64_t{1} << 20;

class BlobRoom;

class BlobStore {
 public:
  // Makes the folder if there is none. Keeps what unfinished uploads of former processes left, to go on with.
  static Result<BlobStore> Open(const std::string& path, uint64_t bytes_max = kBlobBytesDefault);

  // Gives the packages of all open jobs; nothing if that cannot be told now. Set before others use the store;
  // called from any thread.
  using PackagesInUse = std::function<std::optional<std::vector<Digest>>()>;
  void Protect(PackagesInUse in_use);

  // The size of a blob; nothing if it is not there.
  std::optional<uint64_t> Size(const Digest& digest) const;
  bool Has(const Digest& digest) const { return Size(digest).has_value(); }
  // The same, and it is not given up for some time.
  std::optional<uint64_t> Use(const Digest& digest) const;
  // A whole blob of at most `size_max` bytes, its digest checked.
  Result<std::string> Read(const Digest& digest, uint64_t size_max) const;
  Result<void> Write(const Digest& digest, std::string_view bytes) const;
  // Bytes on disk, with those that uploads are about to bring.
  uint64_t bytes() const;

  // A blob that comes in pieces. One thread at a time. What came of one that is not finished is kept, if it
  // is worth it, and another upload may go on from there.
  class Upload {
   public:
    ~Upload();
    Upload(const Upload&) = delete;
    Upload& operator=(const Upload&) = delete;
    // An error (kFailed) if the disk refuses it; kBadInput if it is more than was announced.
    Result<void> Add(std::string_view bytes);
    bool IsWhole() const { return received_ == size_; }
    // Puts the blob at its name, synced. An error (kBadInput) if size or digest are not those announced;
    // kInterrupted if that may be the fault of what an earlier upload had left, which is gone now.
    Result<void> Finish();

   private:
    friend class BlobStore;
    Upload() = default;
    Error Fail(Error error);

    std::string temporary_, path_, folder_;
    int file_ = -1;
    bool may_stay_ = false;  // its name is the blob's, so that another upload finds it
    bool failed_ = false;
    Digest digest_;
    uint64_t size_ = 0, offset_ = 0, received_ = 0;
    Sha256Stream hash_;
    std::shared_ptr<BlobRoom> room_;  // shared: an upload may outlive the store
  };
  // `offset` is how much of it is there already. An error: kBadInput if it is too large; kFailed if there is
  // no room; kInterrupted if so much is not there, or somebody else is sending it.
  Result<std::unique_ptr<Upload>> Begin(const Digest& digest, uint64_t size, uint64_t offset = 0) const;
  // Bytes of an unfinished upload, from its begin.
  uint64_t Unfinished(const Digest& digest) const;

  // Where a blob is that is there: for reading in pieces.
  std::string Path(const Digest& digest) const;

 private:
  BlobStore(std::string path, uint64_t bytes_max);
  std::string Folder(const Digest& digest) const;
  std::string IncomingPath(const Digest& digest) const;
  Result<int> OpenIncoming(const Digest& digest, uint64_t offset, Upload& upload) const;

  std::string path_;
  std::shared_ptr<BlobRoom> room_;
};

}  // namespace tessera
