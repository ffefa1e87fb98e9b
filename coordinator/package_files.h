// Which files belong to which scene package, for calls that name both. Thread safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "proto/blobs/blob_store.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

class PackageFiles {
 public:
  // Of the packages that were asked for last, as long as one of them is known: 32 MB.
  static constexpr size_t kFilesMax = 1'000'000;

  explicit PackageFiles(const BlobStore& blobs) : blobs_(blobs) {}
  // Whether the blob is the manifest of the package or a file that it lists. Reads the manifest unless it is
  // known. The error says why it cannot be read.
  Result<bool> Contains(const Digest& package, const Digest& blob);

 private:
  using Digests = std::shared_ptr<const std::vector<Digest>>;  // in order
  struct Known {
    Digests files;
    uint64_t used = 0;
  };
  Digests Find(const Digest& package);
  void Keep(const Digest& package, Digests files);

  const BlobStore& blobs_;
  std::mutex mutex_;
  std::map<Digest, Known> known_;  // guarded by mutex_
  size_t count_ = 0;               // of their files; guarded by mutex_
  uint64_t clock_ = 0;             // guarded by mutex_
};

}  // namespace tessera
