#include "proto/blobs/blob_room.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "proto/blobs/blob_folder.h"
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

BlobRoom::BlobRoom(std::shared_ptr<const BlobFolder> folder, BlobStoreOptions options)
    : folder_(std::move(folder)), options_(std::move(options)) {
  for (const File& file : List()) bytes_ += file.size;
}

void BlobRoom::Protect(BlobStore::PackagesInUse in_use) {
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

void BlobRoom::Written(uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  unwritten_ -= std::min(unwritten_, bytes);
}

Result<void> BlobRoom::Take(uint64_t bytes, uint64_t reserved) {
  if (TryTake(bytes, reserved)) return {};
  // Waits for the core thread, so before any lock.
  const auto in_use = NamesInUse();
  if (!in_use) return Error{ErrorKind::kInterrupted, "the coordinator is busy"};
  const std::lock_guard one_at_a_time(evicting_);
  Evict(bytes, *in_use);
  if (TryTake(bytes, reserved)) return {};
  return Refusal(bytes);
}

void BlobRoom::FreeReserve() {
  if (DiskLack(0) == 0) return;
  const auto in_use = NamesInUse();
  if (!in_use) return;
  const std::lock_guard one_at_a_time(evicting_);
  Evict(0, *in_use);
}

bool BlobRoom::TryTake(uint64_t bytes, uint64_t reserved) {
  const std::lock_guard lock(mutex_);
  if (bytes_ + bytes > options_.bytes_max || (bytes > 0 && DiskLack(bytes + unwritten_) > 0)) return false;
  bytes_ += reserved;
  unwritten_ += reserved;
  return true;
}

uint64_t BlobRoom::ReserveOf(const DiskSpace& disk) const {
  return std::min(disk.total / kReserveDivisor, options_.disk_reserve_max);
}

// How many bytes have to be freed so that `bytes` can be written and the reserve is left.
uint64_t BlobRoom::DiskLack(uint64_t bytes) const {
  const auto disk = options_.disk_space(folder_->location());
  if (!disk) return 0;
  const uint64_t needed = bytes + ReserveOf(*disk);
  return needed - std::min(needed, disk->free);
}

std::vector<BlobRoom::File> BlobRoom::List() const {
  std::vector<File> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder_->location() + "/", error), end; !error && it != end;
       it.increment(error)) {
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
    const auto manifest =
        ReadFile(fmt::format("{}/{}/{}", folder_->location(), hex.substr(0, 2), hex), kManifestBytesMax);
    // Without its manifest the job fails, so there is nothing to protect.
    if (!manifest) continue;
    const auto package = DecodeScenePackage(*manifest);
    if (!package) continue;
    for (const auto& [path, file] : package->files) names.insert(file.digest.Hex());
  }
  return names;
}

// Removes the least recently used blobs that nobody needs until `bytes` more fit, and some more: then not
// every blob has to look for room.
void BlobRoom::Evict(uint64_t bytes, const std::set<std::string>& in_use) {
  std::vector<File> files = List();
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) {
    return a.used != b.used ? a.used < b.used : a.path < b.path;
  });
  uint64_t total = 0;
  for (const File& file : files) total += file.size;
  const auto recent = fs::file_time_type::clock::now() - options_.grace;
  uint64_t lack = 0, surplus = 0;
  {
    const std::lock_guard lock(mutex_);
    if (options_.shared) bytes_ = total + unwritten_;
    const uint64_t target = options_.bytes_max - options_.bytes_max / kSlackDivisor;
    if (bytes_ + bytes > options_.bytes_max) surplus = bytes_ + bytes - std::min(target, bytes_ + bytes);
    lack = DiskLack(bytes + unwritten_);
    if (lack > 0) lack += lack / kSlackDivisor;
  }
  uint64_t freed = 0;
  for (const File& file : files) {
    if (file.used >= recent || freed >= std::max(surplus, lack)) break;
    if (in_use.contains(file.path.filename().string()) || !RemoveIfIdle(file.path.string())) continue;
    freed += file.size;
    Give(file.size);
  }
}

Error BlobRoom::Refusal(uint64_t bytes) const {
  const std::lock_guard lock(mutex_);
  const auto disk = options_.disk_space(folder_->location());
  const bool fits = bytes_ + bytes <= options_.bytes_max;
  if (bytes_ - std::min(bytes_, unwritten_) + bytes <= options_.bytes_max && DiskLack(bytes) == 0) {
    return {ErrorKind::kInterrupted,
            fmt::format("{}: no room for {} bytes now: {} are reserved for uploads that are running",
                        folder_->name(), bytes, unwritten_)};
  }
  if (fits && disk) {
    return Failed(fmt::format(
        "{}: No space left on device for {} bytes: its file system has {} bytes left, of which {} are "
        "reserved for the journal and for results; free some space or cancel jobs",
        folder_->name(), bytes, disk->free, ReserveOf(*disk)));
  }
  if (bytes > options_.bytes_max || options_.grace.count() == 0) {
    return Failed(fmt::format("{}: no room for {} bytes: the limit of {} is {}", folder_->name(), bytes,
                              options_.limit_flag, options_.bytes_max));
  }
  return Failed(
      fmt::format("{}: no room for {} bytes: open jobs and uploads of the last {} minutes need what is "
                  "there; wait, cancel "
                  "jobs or raise {} (now {})",
                  folder_->name(), bytes, options_.grace.count(), options_.limit_flag, options_.bytes_max));
}

}  // namespace tessera
