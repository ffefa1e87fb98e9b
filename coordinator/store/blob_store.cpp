#include "coordinator/store/blob_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "coordinator/store/blob_room.h"
#include "proto/terms.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr std::chrono::hours kUnfinishedAgeMax{24};         // nobody comes back for an older upload
constexpr uint64_t kWorthKeepingBytes = uint64_t{1} << 20;  // of an upload that was cut short
constexpr size_t kPieceBytes = size_t{1} << 20;

}  // namespace

Result<BlobStore> BlobStore::Open(const std::string& path, uint64_t bytes_max) {
  namespace fs = std::filesystem;
  const std::string incoming = path + "/incoming";
  std::error_code error;
  fs::create_directories(incoming, error);
  if (error) return Failed(fmt::format("{}: cannot be made: {}", path, error.message()));
  const auto stale = fs::file_time_type::clock::now() - kUnfinishedAgeMax;
  for (const auto& entry : fs::directory_iterator(incoming, error)) {
    std::error_code ignored;
    // A name with a dot is of an upload that nobody can go on with.
    const bool is_private = entry.path().filename().string().find('.') != std::string::npos;
    if (is_private || entry.last_write_time(ignored) < stale) fs::remove(entry.path(), ignored);
  }
  if (error) return Failed(fmt::format("{}: cannot be read: {}", incoming, error.message()));
  return BlobStore(path, bytes_max);
}

BlobStore::BlobStore(std::string path, uint64_t bytes_max)
    : path_(std::move(path)), room_(std::make_shared<BlobRoom>(path_, bytes_max)) {}

void BlobStore::Protect(PackagesInUse in_use) {
  room_->Protect(std::move(in_use));
}

uint64_t BlobStore::bytes() const {
  return room_->bytes();
}

// Two levels, so that no folder gets long.
std::string BlobStore::Folder(const Digest& digest) const {
  return path_ + "/" + digest.Hex().substr(0, 2);
}

std::string BlobStore::Path(const Digest& digest) const {
  return Folder(digest) + "/" + digest.Hex();
}

std::optional<uint64_t> BlobStore::Size(const Digest& digest) const {
  struct stat status {};
  if (::stat(Path(digest).c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<uint64_t>(status.st_size);
}

std::optional<uint64_t> BlobStore::Use(const Digest& digest) const {
  const auto size = Size(digest);
  if (size) ::utimensat(AT_FDCWD, Path(digest).c_str(), nullptr, 0);  // now
  return size;
}

Result<std::string> BlobStore::Read(const Digest& digest, uint64_t size_max) const {
  if (!Has(digest)) return BadInput(fmt::format("there is no blob {}", digest.Hex()));
  auto bytes = ReadFile(Path(digest), size_max);
  if (bytes && Sha256(*bytes) != digest)
    return Failed(Path(digest) + ": is damaged: its bytes are not its digest's");
  return bytes;
}

Result<void> BlobStore::Write(const Digest& digest, std::string_view bytes) const {
  auto upload = Begin(digest, bytes.size());
  if (!upload) return upload.error();
  if (const auto added = (*upload)->Add(bytes); !added) return added.error();
  return (*upload)->Finish();
}

std::string BlobStore::IncomingPath(const Digest& digest) const {
  return fmt::format("{}/incoming/{}", path_, digest.Hex());
}

uint64_t BlobStore::Unfinished(const Digest& digest) const {
  struct stat status {};
  if (::stat(IncomingPath(digest).c_str(), &status) != 0) return 0;
  return static_cast<uint64_t>(status.st_size);
}

// The file that an upload writes to, cut at `offset`. The one that others may go on with, unless somebody
// writes to it now: then one of its own.
Result<int> BlobStore::OpenIncoming(const Digest& digest, uint64_t offset, Upload& upload) const {
  upload.temporary_ = IncomingPath(digest);
  const int file = ::open(upload.temporary_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) return SystemError(upload.temporary_, "cannot be created");
  struct stat ours {};
  struct stat named {};
  // The name may have been taken from the file before it was locked: then it is a blob by now.
  upload.may_stay_ = ::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &ours) == 0 &&
                     ::stat(upload.temporary_.c_str(), &named) == 0 && ours.st_ino == named.st_ino;
  if (upload.may_stay_) {
    const auto size = static_cast<uint64_t>(ours.st_size);
    if (offset <= size && ::ftruncate(file, static_cast<off_t>(offset)) == 0) {
      room_->Give(size - offset);
      return file;
    }
    upload.may_stay_ = false;
  }
  ::close(file);
  if (offset > 0)
    return Error{ErrorKind::kInterrupted, "what was sent of the file before is not there; send it again"};
  upload.temporary_ += ".XXXXXX";
  const int own = ::mkostemp(upload.temporary_.data(), O_CLOEXEC);
  if (own < 0) return SystemError(upload.temporary_, "cannot be created");
  return own;
}

Result<std::unique_ptr<BlobStore::Upload>> BlobStore::Begin(const Digest& digest, uint64_t size,
                                                            uint64_t offset) const {
  if (size > kBlobBytesMax)
    return BadInput(fmt::format("blob {}: {} bytes are too many", digest.Hex(), size));
  if (offset > size) return BadInput(fmt::format("blob {}: begins beyond its end", digest.Hex()));
  if (auto taken = room_->Take(size - offset); !taken) return taken.error();
  std::unique_ptr<Upload> upload(new Upload);
  upload->digest_ = digest;
  upload->size_ = size;
  upload->offset_ = upload->received_ = offset;
  upload->folder_ = Folder(digest);
  upload->path_ = Path(digest);
  const auto file = OpenIncoming(digest, offset, *upload);
  if (!file) {
    room_->Give(size - offset);
    return file.error();
  }
  upload->file_ = *file;
  upload->room_ = room_;
  std::string piece(kPieceBytes, '\0');
  for (uint64_t at = 0; at < offset;) {
    const ssize_t count =
        ::pread(*file, piece.data(), std::min<uint64_t>(piece.size(), offset - at), static_cast<off_t>(at));
    if (count <= 0) return upload->Fail(SystemError(upload->temporary_, "cannot be read"));
    upload->hash_.Add(std::string_view(piece).substr(0, static_cast<size_t>(count)));
    at += static_cast<uint64_t>(count);
  }
  ::lseek(*file, static_cast<off_t>(offset), SEEK_SET);
  return upload;
}

BlobStore::Upload::~Upload() {
  if (file_ < 0) return;
  const bool stays = may_stay_ && !failed_ && received_ >= kWorthKeepingBytes;
  if (!stays) ::unlink(temporary_.c_str());
  ::close(file_);  // and with it goes the lock
  room_->Give(stays ? size_ - received_ : size_);
}

Error BlobStore::Upload::Fail(Error error) {
  failed_ = true;
  return error;
}

Result<void> BlobStore::Upload::Add(std::string_view bytes) {
  if (bytes.size() > size_ - received_)
    return Fail(BadInput(fmt::format("blob {}: more bytes than announced", digest_.Hex())));
  hash_.Add(bytes);
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Fail(SystemError(temporary_, "cannot be written"));
    bytes.remove_prefix(static_cast<size_t>(count));
    received_ += static_cast<uint64_t>(count);
  }
  return {};
}

Result<void> BlobStore::Upload::Finish() {
  if (!IsWhole()) {
    return Fail(BadInput(fmt::format("blob {}: {} bytes instead of {}", digest_.Hex(), received_, size_)));
  }
  failed_ = true;  // unless all of it succeeds
  if (hash_.Finish() != digest_) {
    const ErrorKind kind = offset_ > 0 ? ErrorKind::kInterrupted : ErrorKind::kBadInput;
    return Error{kind, fmt::format("blob {}: its bytes are not its digest's", digest_.Hex())};
  }
  if (::mkdir(folder_.c_str(), 0755) != 0 && errno != EEXIST) return SystemError(folder_, "cannot be made");
  if (::fsync(file_) != 0) return SystemError(temporary_, "cannot be synced");
  const bool is_copy = ::access(path_.c_str(), F_OK) == 0;  // somebody was sooner
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return SystemError(path_, "cannot be written");
  ::close(file_);
  file_ = -1;  // nothing to drop any more
  if (is_copy) room_->Give(size_);
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return {};
}

}  // namespace tessera
