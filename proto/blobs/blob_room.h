// How many bytes a blob store holds, and what is evicted when that is too much, for its own limit or for the
// disk.
#pragma once

#include <memory>
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
  BlobRoom(std::shared_ptr<const BlobFolder> folder, BlobStoreOptions options);
  void Protect(BlobStore::PackagesInUse in_use);
  // Makes room for `bytes`, evicting blobs if necessary, and reserves the first `reserved` of them. An error
  // if that does not suffice; kInterrupted: try again, as running uploads have reserved the room.
  Result<void> Take(uint64_t bytes, uint64_t reserved);
  // Releases this many reserved bytes: they have been written, or will not be.
  void Written(uint64_t bytes);
  void Give(uint64_t bytes);
  // Evicts blobs until the reserve of the disk is free, as far as that is possible.
  void FreeReserve();
  bool IsDiskLow() const { return DiskLack(0) > 0; }
  uint64_t bytes() const;

 private:
  struct File;
  std::vector<File> List() const;
  // The names of blobs that open jobs need; nullopt if that is not known now.
  std::optional<std::set<std::string>> NamesInUse() const;
  bool TryTake(uint64_t bytes, uint64_t reserved);
  uint64_t ReserveOf(const DiskSpace& disk) const;
  uint64_t DiskLack(uint64_t bytes) const;
  void Evict(uint64_t bytes, const std::set<std::string>& in_use);
  Error Refusal(uint64_t bytes) const;

  const std::shared_ptr<const BlobFolder> folder_;
  const BlobStoreOptions options_;
  BlobStore::PackagesInUse in_use_;  // constant once other threads use the room
  std::mutex evicting_;              // one thread at a time evicts; it is locked before mutex_
  mutable std::mutex mutex_;         // of the members below
  uint64_t bytes_ = 0;
  uint64_t unwritten_ = 0;  // of bytes_: reserved, and not on the disk yet
};

}  // namespace tessera
