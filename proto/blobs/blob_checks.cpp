#include "proto/blobs/blob_checks.h"

#include <fcntl.h>
#include <sys/stat.h>

namespace tessera {
namespace {

// Beyond these all entries are dropped and determined again. Far above what a farm uses at the same time.
constexpr size_t kKnownMax = 1'000'000;
constexpr size_t kUnfinishedMax = 1024;

std::optional<FileStamp> StampOf(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) return std::nullopt;
  return FileStamp{static_cast<uint64_t>(status.st_ino), static_cast<uint64_t>(status.st_size),
                   int64_t{status.st_ctim.tv_sec} * 1'000'000'000 + status.st_ctim.tv_nsec};
}

}  // namespace

std::optional<FileStamp> FileStamp::Of(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? StampOf(status) : std::nullopt;
}

std::optional<FileStamp> FileStamp::Of(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 ? StampOf(status) : std::nullopt;
}

std::optional<BlobChecks::State> BlobChecks::Use(const Digest& digest, const std::string& path) {
  const std::lock_guard lock(mutex_);
  const auto before = FileStamp::Of(path);
  if (!before) return std::nullopt;
  ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // now
  const auto after = FileStamp::Of(path);
  if (!after) return std::nullopt;
  if (known_.size() >= kKnownMax) known_.clear();
  Known& known = known_[digest];
  if (known.stamp != *before) known = {*before, ++versions_, false};
  known.stamp = *after;
  return State{after->size, known.version, known.is_verified};
}

void BlobChecks::SetVerified(const Digest& digest, const std::string& path, uint64_t version) {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(digest);
  if (found == known_.end() || found->second.version != version) return;
  if (FileStamp::Of(path) == found->second.stamp) found->second.is_verified = true;
}

void BlobChecks::Add(const Digest& digest, const std::string& path) {
  const std::lock_guard lock(mutex_);
  if (const auto stamp = FileStamp::Of(path)) known_[digest] = {*stamp, ++versions_, true};
}

void BlobChecks::Forget(const Digest& digest) {
  const std::lock_guard lock(mutex_);
  known_.erase(digest);
}

void BlobChecks::KeepHash(const Digest& digest, const FileStamp& stamp, std::unique_ptr<Sha256Stream> hash) {
  const std::lock_guard lock(mutex_);
  if (unfinished_.size() >= kUnfinishedMax) unfinished_.clear();
  unfinished_[digest] = {stamp, std::move(hash)};
}

std::unique_ptr<Sha256Stream> BlobChecks::TakeHash(const Digest& digest, const FileStamp& stamp) {
  const std::lock_guard lock(mutex_);
  const auto found = unfinished_.find(digest);
  if (found == unfinished_.end()) return nullptr;
  Unfinished unfinished = std::move(found->second);
  unfinished_.erase(found);
  if (unfinished.stamp != stamp) return nullptr;
  return std::move(unfinished.hash);
}

}  // namespace tessera
