// Files by their SHA-256, in a folder: what a coordinator keeps of scenes, and what a worker caches of them.
//   xx/DIGEST          a whole blob (xx: the first two digits); its time of modification is its last use
//   incoming/DIGEST    what has arrived of a blob, to be resumed
//   incoming/DIGEST.*  a second copy that arrives at the same time; not resumed
// A blob has its name only once it is whole and verified. Disks damage files later: see UseVerified. Least
// recently used blobs are evicted when room is needed.
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

// Of the file system that holds a folder.
struct DiskSpace {
  uint64_t total = 0, free = 0;  // bytes
};
// nullopt if it is not known.
std::optional<DiskSpace> DiskSpaceOf(const std::string& folder);

// On a small disk the reserve is this part of it.
constexpr uint64_t kReserveDivisor = 20;

struct BlobStoreOptions {
  uint64_t bytes_max = 0;
  // A blob used within this time is not evicted: a client that was told that it is there is about to submit a
  // job.
  std::chrono::minutes grace{0};
  // Blobs are synced before they count as whole. Without it, damage after a crash is found when a blob is
  // read.
  bool durable = false;
  // Other processes use the folder too. What they add is counted when room is needed.
  bool shared = false;
  // The flag that sets bytes_max, for messages.
  std::string limit_flag;
  // Blobs leave this many bytes of the disk to others.
  uint64_t disk_reserve_max = 0;
  std::function<std::optional<DiskSpace>(const std::string& folder)> disk_space = DiskSpaceOf;

  // Of a coordinator: the only copy, in a folder of its own. The client may have the rest of a large scene to
  // send before it submits, hence the grace. The reserve is for the journal and the spool.
  static BlobStoreOptions Origin(uint64_t bytes_max) {
    return {bytes_max, std::chrono::minutes(30), true, false, "--blobs-size", uint64_t{1} << 30};
  }
  // Of a worker: copies that can be fetched again, in a folder that the workers of a machine share.
  static BlobStoreOptions Cache(uint64_t bytes_max) {
    return {bytes_max, std::chrono::minutes(0), false, true, "--cache-size", 0};
  }
};

class BlobChecks;
class BlobFolder;
class BlobRoom;

// Thread safe.
class BlobStore {
 public:
  // Creates the folder if there is none and removes incoming files that nobody can resume. The store stays in
  // this folder, even if it is renamed or another takes its place.
  static Result<BlobStore> Open(const std::string& path, const BlobStoreOptions& options);
  // The same in a folder that is open.
  static Result<BlobStore> Open(std::shared_ptr<const BlobFolder> folder, const BlobStoreOptions& options);

  // Returns the scene packages of all open jobs, whose blobs are not evicted; nullopt if that is not known
  // now. Set it before other threads use the store. Called from any thread.
  using PackagesInUse = std::function<std::optional<std::vector<Digest>>()>;
  void Protect(PackagesInUse in_use);

  // The size of a blob; nullopt if it is not there.
  std::optional<uint64_t> Size(const Digest& digest) const;
  bool Has(const Digest& digest) const { return Size(digest).has_value(); }
  // The same, and marks the blob as used now.
  std::optional<uint64_t> Use(const Digest& digest) const;
  // The same without the size. Never reads the bytes, so it may not know whether they have the digest.
  enum class Presence { kMissing, kIntact, kUnknown };
  Presence Look(const Digest& digest) const;
  // Use, for a blob whose bytes have its digest. A corrupt one is removed and counts as missing. Reads the
  // bytes only if they were not verified since this process started, or if the file was written to since:
  // slow then.
  std::optional<uint64_t> UseVerified(const Digest& digest) const;
  // Somebody received other bytes than those of the digest: the next UseVerified reads them.
  void Suspect(const Digest& digest) const;
  // Evicts blobs until the reserve of the disk is free, as far as that is possible. Slow.
  void FreeReserve() const;
  // Whether the reserve of the disk is not free.
  bool IsDiskLow() const;
  // A whole blob of at most `size_max` bytes. An error if it is not there, too large or corrupt.
  Result<std::string> Read(const Digest& digest, uint64_t size_max) const;
  Result<void> Write(const Digest& digest, std::string_view bytes) const;
  // Does nothing if the blob is not there.
  void Remove(const Digest& digest) const;
  // Bytes on disk, including those reserved for what is arriving.
  uint64_t bytes() const;
  uint64_t bytes_max() const { return options_.bytes_max; }

  // A blob that arrives in pieces. Used by one thread at a time. What has arrived of an unfinished one is
  // kept, if it is large enough to be worth it, and can be resumed, also by another process.
  class Partial {
   public:
    ~Partial();
    Partial(const Partial&) = delete;
    Partial& operator=(const Partial&) = delete;
    uint64_t received() const { return received_; }
    bool IsWhole() const { return received_ == size_; }
    // An error (kFailed) if it cannot be written; kBadInput if the bytes are more than announced;
    // kInterrupted if running uploads have reserved the room, so what has arrived is kept for another
    // attempt.
    Result<void> Add(std::string_view bytes);
    // Verifies the blob and gives it its name. An error (kBadInput) if size or digest are not those
    // announced; kInterrupted if bytes that had arrived earlier may be the cause: they are gone, so another
    // attempt is worth it.
    Result<void> Finish();

   private:
    friend class BlobStore;
    Partial() = default;
    Error Fail(Error error);
    Result<void> Reserve(uint64_t bytes);

    std::string temporary_, path_, folder_;
    int file_ = -1;
    bool resumable_ = false;  // the temporary name is the one that others resume from
    bool failed_ = false;
    bool durable_ = false;
    Digest digest_;
    uint64_t size_ = 0, resumed_at_ = 0, received_ = 0;
    uint64_t reserved_ = 0;               // what has arrived and the bytes after it for which there is room
    std::unique_ptr<Sha256Stream> hash_;  // of what was received
    // Shared: a partial blob may outlive the store.
    std::shared_ptr<const BlobFolder> store_;
    std::shared_ptr<BlobRoom> room_;
    std::shared_ptr<BlobChecks> checks_;
  };
  // Makes room for a blob of `size` bytes that begins to arrive, and reserves some of it ahead of what
  // arrives: a size is announced at no cost. Its first `offset` bytes have arrived earlier (see Arrived). An
  // error: kBadInput if it is too large; kFailed if there is no room; kInterrupted if running uploads have
  // reserved the room, if fewer bytes have arrived, or if they are just being received by somebody else. Slow
  // if this process has not hashed the first bytes yet.
  Result<std::unique_ptr<Partial>> Begin(const Digest& digest, uint64_t size, uint64_t offset = 0) const;
  // Resumes where it stopped; null if somebody else is receiving the blob now.
  Result<std::unique_ptr<Partial>> Resume(const Digest& digest, uint64_t size) const;
  // How many bytes of an unfinished blob can be resumed from.
  uint64_t Arrived(const Digest& digest) const;

  // Where a blob is that is there: for reading in pieces, by this process or its children. Not for messages.
  std::string Path(const Digest& digest) const;

 private:
  BlobStore(std::shared_ptr<const BlobFolder> folder, BlobStoreOptions options);
  std::string Folder(const Digest& digest) const;
  std::string IncomingPath(const Digest& digest) const;
  Result<std::unique_ptr<Partial>> Receive(const Digest& digest, uint64_t size, uint64_t offset,
                                           bool alone) const;
  Result<int> OpenIncoming(uint64_t offset, bool alone, Partial& partial) const;
  Result<void> HashReceived(Partial& partial) const;

  std::shared_ptr<const BlobFolder> folder_;
  BlobStoreOptions options_;
  std::shared_ptr<BlobRoom> room_;
  std::shared_ptr<BlobChecks> checks_;
};

}  // namespace tessera
