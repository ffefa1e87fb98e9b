// How many bytes a blob store holds, and what is evicted when that is too much.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/blobs/blob_store.h"

namespace tessera {

// Removes a file that no process has locked for writing. Returns whether it is gone.
bool RemoveIfIdle(const std::string& path);

// Thread safe.
class BlobRoom {
 public:
  // Counts what is in the folder.
  BlobRoom(std::string path, BlobStoreOptions options);
  void Protect(BlobStore::PackagesInUse in_use);
  // Reserves `bytes`, evicting blobs if necessary. An error if that does not suffice; kInterrupted: try
  // again.
  Result<void> Take(uint64_t bytes);
  void Give(uint64_t bytes);
  uint64_t bytes() const;

 private:
  struct File;
  std::vector<File> List() const;
  // The names of blobs that open jobs need; nullopt if that is not known now.
  std::optional<std::set<std::string>> NamesInUse() const;
  Result<void> MakeRoom(uint64_t bytes);

  const std::string path_;
  const BlobStoreOptions options_;
  mutable std::mutex mutex_;  // of the members below
  BlobStore::PackagesInUse in_use_;
  uint64_t bytes_ = 0;
};

}  // namespace tessera
