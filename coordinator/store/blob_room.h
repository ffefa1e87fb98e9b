// How much a blob store holds, and what goes when that is too much.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "coordinator/store/blob_store.h"

namespace tessera {

// Thread safe.
class BlobRoom {
 public:
  // Counts what is in the folder.
  BlobRoom(std::string path, uint64_t bytes_max);
  void Protect(BlobStore::PackagesInUse in_use);
  // Room for so many bytes, made if there is none. An error if that cannot be; kInterrupted: try again.
  Result<void> Take(uint64_t bytes);
  void Give(uint64_t bytes);
  uint64_t bytes() const;

 private:
  struct File;
  std::vector<File> List() const;
  // Nothing if it cannot be told now.
  std::optional<std::set<std::string>> NamesInUse() const;
  Result<void> MakeRoom(uint64_t bytes);

  const std::string path_;
  const uint64_t bytes_max_;
  mutable std::mutex mutex_;  // of the members below
  BlobStore::PackagesInUse in_use_;
  uint64_t bytes_ = 0;
};

}  // namespace tessera
