#include "proto/blobs/blob_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "proto/blobs/blob_checks.h"
#include "proto/blobs/blob_folder.h"
#include "proto/blobs/blob_room.h"
#include "proto/terms.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kIncomingAgeMax{24};           // nobody resumes an older one
constexpr uint64_t kWorthKeepingBytes = uint64_t{1} << 20;  // of an unfinished blob
constexpr size_t kPieceBytes = size_t{1} << 20;
// Of room, ahead of what has arrived. All uploads together reserve a gigabyte, and each looks at the disk
// once for this many bytes.
constexpr uint64_t kReservedAheadBytes = uint64_t{16} << 20;

// Opens or creates a file to receive into. A link in its place is removed: it would lead out of the store.
// Returns a negative number on failure, with the reason in errno.
int OpenOwn(const std::string& path) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  const int file = ::open(path.c_str(), kFlags, 0600);
  if (file >= 0 || errno != ELOOP) return file;
  ::unlink(path.c_str());
  return ::open(path.c_str(), kFlags | O_EXCL, 0600);
}

// Removes incoming files that are too old, or that cannot be resumed and that no process writes to.
Result<void> RemoveStale(const std::string& incoming) {
  const auto paths = ListFolder(incoming);
  if (!paths) return paths.error();
  const auto stale = fs::file_time_type::clock::now() - kIncomingAgeMax;
  for (const std::string& path : *paths) {
    std::error_code ignored;
    const bool resumable = fs::path(path).filename().string().find('.') == std::string::npos;
    if (!resumable || fs::last_write_time(path, ignored) < stale) RemoveIfIdle(path);
  }
  return {};
}

// Adds the first `size` bytes of a file.
Result<void> AddFile(const std::string& path, int file, uint64_t size, Sha256Stream& hash) {
  std::string piece(kPieceBytes, '\0');
  for (uint64_t at = 0; at < size;) {
    const ssize_t count =
        ::pread(file, piece.data(), std::min<uint64_t>(piece.size(), size - at), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return SystemError(path, "cannot be read");
    if (count == 0) return Failed(fmt::format("{}: is shorter than it was", path));
    hash.Add(std::string_view(piece).substr(0, static_cast<size_t>(count)));
    at += static_cast<uint64_t>(count);
  }
  return {};
}

// nullopt if the file cannot be read.
std::optional<Digest> DigestOfFile(const std::string& path, uint64_t size) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  Sha256Stream hash;
  const auto added = AddFile(path, file, size, hash);
  ::close(file);
  if (!added) return std::nullopt;
  return hash.Finish();
}

}  // namespace

std::optional<DiskSpace> DiskSpaceOf(const std::string& folder) {
  struct statvfs space {};
  if (::statvfs(folder.c_str(), &space) != 0 || space.f_blocks == 0) return std::nullopt;
  return DiskSpace{uint64_t{space.f_blocks} * space.f_frsize, uint64_t{space.f_bavail} * space.f_frsize};
}

Result<BlobStore> BlobStore::Open(const std::string& path, const BlobStoreOptions& options) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) return Failed(fmt::format("{}: cannot be created: {}", path, error.message()));
  auto folder = BlobFolder::Open(path);
  if (!folder) return folder.error();
  return Open(std::move(*folder), options);
}

Result<BlobStore> BlobStore::Open(std::shared_ptr<const BlobFolder> folder, const BlobStoreOptions& options) {
  const std::string incoming = folder->location() + "/incoming";
  std::error_code error;
  fs::create_directory(incoming, error);
  if (error)
    return folder->Named(Failed(fmt::format("{}: cannot be created: {}", incoming, error.message())));
  struct stat status {};
  if (::lstat(incoming.c_str(), &status) != 0 || !S_ISDIR(status.st_mode))
    return folder->Named(Failed(fmt::format("{}: is not a folder", incoming)));
  if (::access(incoming.c_str(), W_OK) != 0)
    return folder->Named(SystemError(incoming, "cannot be written to"));
  if (const auto removed = RemoveStale(incoming); !removed) return folder->Named(removed.error());
  return BlobStore(std::move(folder), options);
}

BlobStore::BlobStore(std::shared_ptr<const BlobFolder> folder, BlobStoreOptions options)
    : folder_(std::move(folder)),
      options_(std::move(options)),
      room_(std::make_shared<BlobRoom>(folder_, options_)),
      checks_(std::make_shared<BlobChecks>()) {}

void BlobStore::Protect(PackagesInUse in_use) {
  room_->Protect(std::move(in_use));
}

uint64_t BlobStore::bytes() const {
  return room_->bytes();
}

// Two levels, so that no folder holds too many files.
std::string BlobStore::Folder(const Digest& digest) const {
  return folder_->location() + "/" + digest.Hex().substr(0, 2);
}

std::string BlobStore::Path(const Digest& digest) const {
  return Folder(digest) + "/" + digest.Hex();
}

std::optional<uint64_t> BlobStore::Size(const Digest& digest) const {
  struct stat status {};
  if (::lstat(Path(digest).c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<uint64_t>(status.st_size);
}

std::optional<uint64_t> BlobStore::Use(const Digest& digest) const {
  const auto state = checks_->Use(digest, Path(digest));
  return state ? std::optional(state->size) : std::nullopt;
}

BlobStore::Presence BlobStore::Look(const Digest& digest) const {
  const auto state = checks_->Use(digest, Path(digest));
  if (!state) return Presence::kMissing;
  return state->is_verified ? Presence::kIntact : Presence::kUnknown;
}

std::optional<uint64_t> BlobStore::UseVerified(const Digest& digest) const {
  const std::string path = Path(digest);
  const auto state = checks_->Use(digest, path);
  if (!state) return std::nullopt;
  if (state->is_verified) return state->size;
  const auto found = DigestOfFile(path, state->size);
  if (found == digest) {
    checks_->SetVerified(digest, path, state->version);
    return state->size;
  }
  // A file that cannot be read now may be readable later.
  if (found) Remove(digest);
  return std::nullopt;
}

void BlobStore::Suspect(const Digest& digest) const {
  checks_->Forget(digest);
}

void BlobStore::FreeReserve() const {
  room_->FreeReserve();
}

bool BlobStore::IsDiskLow() const {
  return room_->IsDiskLow();
}

Result<std::string> BlobStore::Read(const Digest& digest, uint64_t size_max) const {
  if (!Has(digest)) return BadInput(fmt::format("there is no blob {}", digest.Hex()));
  auto bytes = ReadFile(Path(digest), size_max);
  if (!bytes) return folder_->Named(bytes.error());
  if (Sha256(*bytes) != digest)
    return folder_->Named(Failed(fmt::format("{}: is corrupt (SHA-256 mismatch)", Path(digest))));
  return bytes;
}

Result<void> BlobStore::Write(const Digest& digest, std::string_view bytes) const {
  auto partial = Begin(digest, bytes.size());
  if (!partial) return partial.error();
  if (const auto added = (*partial)->Add(bytes); !added) return added.error();
  return (*partial)->Finish();
}

void BlobStore::Remove(const Digest& digest) const {
  const auto size = Size(digest);
  if (size && ::unlink(Path(digest).c_str()) == 0) room_->Give(*size);
}

std::string BlobStore::IncomingPath(const Digest& digest) const {
  return fmt::format("{}/incoming/{}", folder_->location(), digest.Hex());
}

uint64_t BlobStore::Arrived(const Digest& digest) const {
  struct stat status {};
  if (::stat(IncomingPath(digest).c_str(), &status) != 0) return 0;
  return static_cast<uint64_t>(status.st_size);
}

// The file that the blob is received into, cut at `offset`: the one that others may resume from or, if
// somebody is writing to that now and the partial need not be `alone`, one of its own.
Result<int> BlobStore::OpenIncoming(uint64_t offset, bool alone, Partial& partial) const {
  partial.temporary_ = IncomingPath(partial.digest_);
  const int file = OpenOwn(partial.temporary_);
  if (file < 0) return folder_->Named(SystemError(partial.temporary_, "cannot be created"));
  struct stat ours {};
  struct stat named {};
  // The file may have been renamed before it was locked: then it is a blob by now.
  partial.resumable_ = ::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &ours) == 0 &&
                       ::lstat(partial.temporary_.c_str(), &named) == 0 && ours.st_ino == named.st_ino;
  if (partial.resumable_) {
    const auto size = static_cast<uint64_t>(ours.st_size);
    if (offset == size) return file;
    if (offset < size && ::ftruncate(file, static_cast<off_t>(offset)) == 0) {
      room_->Give(size - offset);
      return file;
    }
    partial.resumable_ = false;
  }
  ::close(file);
  if (offset > 0 || alone)
    return Error{ErrorKind::kInterrupted, "the bytes sent earlier are no longer there"};
  partial.temporary_ += ".XXXXXX";
  const int own = ::mkostemp(partial.temporary_.data(), O_CLOEXEC);
  if (own < 0) return folder_->Named(SystemError(partial.temporary_, "cannot be created"));
  ::flock(own, LOCK_EX | LOCK_NB);
  return own;
}

Result<std::unique_ptr<BlobStore::Partial>> BlobStore::Begin(const Digest& digest, uint64_t size,
                                                             uint64_t offset) const {
  return Receive(digest, size, offset, false);
}

Result<std::unique_ptr<BlobStore::Partial>> BlobStore::Resume(const Digest& digest, uint64_t size) const {
  const uint64_t arrived = Arrived(digest);
  auto partial = Receive(digest, size, arrived <= size ? arrived : 0, true);
  if (!partial && partial.error().kind == ErrorKind::kInterrupted) return std::unique_ptr<Partial>();
  return partial;
}

Result<std::unique_ptr<BlobStore::Partial>> BlobStore::Receive(const Digest& digest, uint64_t size,
                                                               uint64_t offset, bool alone) const {
  if (size > kBlobBytesMax)
    return BadInput(
        fmt::format("blob {}: {} bytes are more than the limit of {}", digest.Hex(), size, kBlobBytesMax));
  if (offset > size) return BadInput(fmt::format("blob {}: the offset is beyond its end", digest.Hex()));
  const uint64_t reserved = std::min(size - offset, kReservedAheadBytes);
  if (auto taken = room_->Take(size - offset, reserved); !taken) return taken.error();
  std::unique_ptr<Partial> partial(new Partial);
  partial->digest_ = digest;
  partial->size_ = size;
  partial->resumed_at_ = partial->received_ = offset;
  partial->reserved_ = offset + reserved;
  partial->durable_ = options_.durable;
  partial->folder_ = Folder(digest);
  partial->path_ = Path(digest);
  const auto file = OpenIncoming(offset, alone, *partial);
  if (!file) {
    room_->Written(reserved);
    room_->Give(reserved);
    return file.error();
  }
  partial->file_ = *file;
  partial->store_ = folder_;
  partial->room_ = room_;
  partial->checks_ = checks_;
  if (const auto hashed = HashReceived(*partial); !hashed) return partial->Fail(hashed.error());
  ::lseek(*file, static_cast<off_t>(offset), SEEK_SET);
  return partial;
}

// Takes up the hash of what was received earlier where this process left it, or hashes it.
Result<void> BlobStore::HashReceived(Partial& partial) const {
  const auto stamp = FileStamp::Of(partial.file_);
  if (partial.received_ > 0 && stamp) partial.hash_ = checks_->TakeHash(partial.digest_, *stamp);
  if (partial.hash_ != nullptr) return {};
  partial.hash_ = std::make_unique<Sha256Stream>();
  return AddFile(partial.temporary_, partial.file_, partial.received_, *partial.hash_);
}

BlobStore::Partial::~Partial() {
  if (file_ < 0) return;
  const bool kept = resumable_ && !failed_ && received_ >= kWorthKeepingBytes;
  if (!kept) ::unlink(temporary_.c_str());
  const auto stamp = FileStamp::Of(file_);
  if (kept && stamp) checks_->KeepHash(digest_, *stamp, std::move(hash_));
  ::close(file_);  // releases the lock
  room_->Written(reserved_ - received_);
  room_->Give(kept ? reserved_ - received_ : reserved_);
}

Error BlobStore::Partial::Fail(Error error) {
  failed_ = true;
  return store_->Named(std::move(error));
}

// Looks for room for all that is to come: an upload that cannot be finished leaves the rest to others.
Result<void> BlobStore::Partial::Reserve(uint64_t bytes) {
  if (bytes <= reserved_ - received_) return {};
  const uint64_t left = size_ - reserved_;
  const uint64_t more = std::min(left, std::max(kReservedAheadBytes, bytes - (reserved_ - received_)));
  if (auto taken = room_->Take(left, more); !taken) return taken;
  reserved_ += more;
  return {};
}

Result<void> BlobStore::Partial::Add(std::string_view bytes) {
  if (bytes.size() > size_ - received_)
    return Fail(BadInput(fmt::format("blob {}: more bytes than announced", digest_.Hex())));
  if (auto reserved = Reserve(bytes.size()); !reserved) return reserved;
  hash_->Add(bytes);
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Fail(SystemError(temporary_, "cannot be written"));
    bytes.remove_prefix(static_cast<size_t>(count));
    received_ += static_cast<uint64_t>(count);
    room_->Written(static_cast<uint64_t>(count));
  }
  return {};
}

Result<void> BlobStore::Partial::Finish() {
  if (!IsWhole())
    return Fail(BadInput(fmt::format("blob {}: {} bytes instead of {}", digest_.Hex(), received_, size_)));
  failed_ = true;  // unless everything below succeeds
  if (const Digest found = hash_->Finish(); found != digest_) {
    const ErrorKind kind = resumed_at_ > 0 ? ErrorKind::kInterrupted : ErrorKind::kBadInput;
    return Error{kind,
                 fmt::format("blob {}: SHA-256 mismatch: the bytes have {}", digest_.Hex(), found.Hex())};
  }
  const bool is_new = ::mkdir(folder_.c_str(), 0700) == 0;
  if (!is_new && errno != EEXIST) return Fail(SystemError(folder_, "cannot be created"));
  struct stat status {};
  if (::lstat(folder_.c_str(), &status) != 0 || !S_ISDIR(status.st_mode))
    return Fail(Failed(fmt::format("{}: is not a folder", folder_)));
  if (is_new && durable_) {
    if (const auto synced = SyncFolder(folder_ + "/.."); !synced) return Fail(synced.error());
  }
  if (durable_ && ::fsync(file_) != 0) return Fail(SystemError(temporary_, "cannot be synced"));
  bool is_copy = false;
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) != 0) {
    // Somebody else was faster, or the file system cannot tell.
    is_copy = errno == EEXIST || ::access(path_.c_str(), F_OK) == 0;
    if (::rename(temporary_.c_str(), path_.c_str()) != 0)
      return Fail(SystemError(path_, "cannot be written"));
  }
  ::close(file_);
  file_ = -1;  // nothing is left for the destructor
  if (is_copy) room_->Give(size_);
  checks_->Add(digest_, path_);
  if (!durable_) return {};
  const auto synced = SyncFolder(folder_);
  return synced ? synced : Fail(synced.error());
}

}  // namespace tessera
