#include "proto/blobs/blob_room.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "proto/scene_package.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Some more room is made than is needed, so that not every blob has to look for it.
constexpr uint64_t kSlackDivisor = 20;

}  // namespace

bool RemoveIfIdle(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return false;
  const bool removed = ::flock(file, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0;
  ::close(file);
  return removed;
}

struct BlobRoom::File {
  fs::path path;
  uint64_t size = 0;
  fs::file_time_type used;
};

BlobRoom::BlobRoom(std::string path, BlobStoreOptions options)
    : path_(std::move(path)), options_(std::move(options)) {
  for (const File& file : List()) bytes_ += file.size;
}

void BlobRoom::Protect(BlobStore::PackagesInUse in_use) {
  const std::lock_guard lock(mutex_);
  in_use_ = std::move(in_use);
}

uint64_t BlobRoom::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void BlobRoom::Give(uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  bytes_ -= std::min(bytes_, bytes);
}

Result<void> BlobRoom::Take(uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes_ + bytes > options_.bytes_max) {
    if (auto made = MakeRoom(bytes); !made) return made;
  }
  bytes_ += bytes;
  return {};
}

std::vector<BlobRoom::File> BlobRoom::List() const {
  std::vector<File> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(path_, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;  // another thread or process has removed it
    if (!it->is_regular_file(gone)) continue;
    const File file{it->path(), it->file_size(gone), it->last_write_time(gone)};
    if (!gone) files.push_back(file);
  }
  return files;
}

std::optional<std::set<std::string>> BlobRoom::NamesInUse() const {
  std::set<std::string> names;
  if (!in_use_) return names;
  const auto packages = in_use_();
  if (!packages) return std::nullopt;
  for (const Digest& digest : *packages) {
    names.insert(digest.Hex());
    const std::string hex = digest.Hex();
    const auto manifest = ReadFile(fmt::format("{}/{}/{}", path_, hex.substr(0, 2), hex), kManifestBytesMax);
    // Without its manifest the job fails, so there is nothing to protect.
    if (!manifest) continue;
    const auto package = DecodeScenePackage(*manifest);
    if (!package) continue;
    for (const auto& [path, file] : package->files) names.insert(file.digest.Hex());
  }
  return names;
}

Result<void> BlobRoom::MakeRoom(uint64_t bytes) {
  const auto in_use = NamesInUse();
  if (!in_use) return Error{ErrorKind::kInterrupted, "the coordinator is busy; try again"};
  std::vector<File> files = List();
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) {
    return a.used != b.used ? a.used < b.used : a.path < b.path;
  });
  if (options_.shared) {
    bytes_ = 0;
    for (const File& file : files) bytes_ += file.size;
  }
  const auto recent = fs::file_time_type::clock::now() - options_.grace;
  const uint64_t target = options_.bytes_max - options_.bytes_max / kSlackDivisor;
  for (const File& file : files) {
    if (file.used >= recent || bytes_ + bytes <= target) break;
    if (in_use->contains(file.path.filename().string())) continue;
    if (RemoveIfIdle(file.path.string())) bytes_ -= std::min(bytes_, file.size);
  }
  if (bytes_ + bytes <= options_.bytes_max) return {};
  if (bytes > options_.bytes_max || options_.grace.count() == 0) {
    return Failed(fmt::format("{}: no room for {} bytes: the limit of {} is {}", path_, bytes,
                              options_.limit_flag, options_.bytes_max));
  }
  return Failed(
      fmt::format("{}: no room for {} bytes: open jobs and uploads of the last {} minutes need what is "
                  "there; wait, cancel "
                  "jobs or raise {} (now {})",
                  path_, bytes, options_.grace.count(), options_.limit_flag, options_.bytes_max));
}

}  // namespace tessera
