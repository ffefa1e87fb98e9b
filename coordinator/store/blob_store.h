// Scene files by their digest. A blob is at its name whole and right, or not at all. Thread safe: the folder
// is its only state.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "util/digest.h"
#include "util/result.h"

namespace tessera {

class BlobStore {
 public:
  // Makes the folder if there is none and removes what unfinished uploads of former processes left.
  static Result<BlobStore> Open(const std::string& path);

  // The size of a blob; nothing if it is not there.
  std::optional<uint64_t> Size(const Digest& digest) const;
  bool Has(const Digest& digest) const { return Size(digest).has_value(); }
  // A whole blob of at most `size_max` bytes, its digest checked.
  Result<std::string> Read(const Digest& digest, uint64_t size_max) const;
  Result<void> Write(const Digest& digest, std::string_view bytes) const;

  // A blob that comes in pieces. Dropped unless Finish succeeds. One thread at a time.
  class Upload {
   public:
    ~Upload();
    Upload(const Upload&) = delete;
    Upload& operator=(const Upload&) = delete;
    // An error (kFailed) if the disk refuses it or it is more than was announced.
    Result<void> Add(std::string_view bytes);
    // Puts the blob at its name, synced. An error (kBadInput) if size or digest are not those announced.
    Result<void> Finish();

   private:
    friend class BlobStore;
    Upload() = default;
    std::string temporary_, path_, folder_;
    int file_ = -1;
    Digest digest_;
    uint64_t size_ = 0, received_ = 0;
    Sha256Stream hash_;
  };
  Result<std::unique_ptr<Upload>> Begin(const Digest& digest, uint64_t size) const;

  // Where a blob is that is there: for reading in pieces.
  std::string Path(const Digest& digest) const;

 private:
  explicit BlobStore(std::string path) : path_(std::move(path)) {}
  std::string Folder(const Digest& digest) const;
  std::string path_;
};

}  // namespace tessera
