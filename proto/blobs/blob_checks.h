// What a process knows of the bytes in a blob store: which blobs it has verified since it started, and how
// far it has hashed those that are arriving. What it knows of a file holds until the file is written to.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "renderer/util/digest.h"

namespace tessera {

// Changes with every write to a file. Damage by the disk itself does not change it.
struct FileStamp {
  uint64_t inode = 0, size = 0;
  int64_t changed_ns = 0;

  bool operator==(const FileStamp&) const = default;
  // nullopt if it is not a regular file.
  static std::optional<FileStamp> Of(const std::string& path);
  static std::optional<FileStamp> Of(int file);
};

// Thread safe.
class BlobChecks {
 public:
  struct State {
    uint64_t size = 0;
    uint64_t version = 0;  // another one after each write to the file that is not a use
    bool is_verified = false;
  };
  // Marks a blob as used now. Returns what is known of it; nullopt if there is no such file.
  std::optional<State> Use(const Digest& digest, const std::string& path);
  // The bytes of that version have the digest. Does nothing if the file has changed since.
  void SetVerified(const Digest& digest, const std::string& path, uint64_t version);
  // The file has just got its name, and its bytes have the digest.
  void Add(const Digest& digest, const std::string& path);
  // The next use verifies the blob.
  void Forget(const Digest& digest);

  // Keeps the hash of all bytes of an unfinished blob, whose file has the stamp.
  void KeepHash(const Digest& digest, const FileStamp& stamp, std::unique_ptr<Sha256Stream> hash);
  // The hash of all bytes of the file; null if it is not known.
  std::unique_ptr<Sha256Stream> TakeHash(const Digest& digest, const FileStamp& stamp);

 private:
  struct Known {
    FileStamp stamp;
    uint64_t version = 0;
    bool is_verified = false;
  };
  struct Unfinished {
    FileStamp stamp;
    std::unique_ptr<Sha256Stream> hash;
  };
  std::mutex mutex_;  // of all members
  uint64_t versions_ = 0;
  std::map<Digest, Known> known_;
  std::map<Digest, Unfinished> unfinished_;
};

}  // namespace tessera
