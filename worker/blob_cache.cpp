#include "worker/blob_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "renderer/description/file_source.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPieceBytes = size_t{1} << 20;
constexpr std::string_view kTemporaryMark = ".tmp-";
constexpr std::chrono::hours kTemporaryAgeMax{24};  // older ones were left behind by a crash

struct CachedFile {
  fs::path path;
  uint64_t size = 0;
  fs::file_time_type used;
};

std::vector<CachedFile> ListFiles(const std::string& folder) {
  std::vector<CachedFile> files;
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
  while (!error && it != end) {
    std::error_code ignored;  // another process may remove the file under our eyes
    if (it->is_regular_file(ignored)) {
      const uint64_t size = it->file_size(ignored);
      const auto used = it->last_write_time(ignored);
      if (!ignored) files.push_back({it->path(), size, used});
    }
    it.increment(error);
  }
  return files;
}

// Whether the process that wrote a file beside its final name has ended. If another machine shares the folder
// it may be wrong; the other then fails to keep one file, and has it all the same.
bool IsAbandoned(const fs::path& path) {
  const std::string name = path.filename().string();
  const size_t mark = name.find(kTemporaryMark);
  if (mark == std::string::npos) return false;
  const int process = std::atoi(name.c_str() + mark + kTemporaryMark.size());
  return process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
}

std::vector<CachedFile> ListWithoutAbandoned(const std::string& folder) {
  std::vector<CachedFile> files = ListFiles(folder);
  std::erase_if(files, [](const CachedFile& file) {
    std::error_code ignored;
    return IsAbandoned(file.path) && fs::remove(file.path, ignored);
  });
  return files;
}

uint64_t TotalSize(const std::vector<CachedFile>& files) {
  uint64_t total = 0;
  for (const CachedFile& file : files) total += file.size;
  return total;
}

}  // namespace

Result<void> BlobCache::Prepare(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || ::access(folder.c_str(), W_OK) != 0) {
    return BadInput(fmt::format("--cache-dir: {} cannot be written to", folder));
  }
  return {};
}

BlobCache::BlobCache(std::string folder, uint64_t bytes_max)
    : folder_(std::move(folder)), bytes_max_(bytes_max), bytes_(TotalSize(ListWithoutAbandoned(folder_))) {}

std::string BlobCache::PathOf(const Digest& digest) const {
  const std::string hex = digest.Hex();
  return fmt::format("{}/{}/{}", folder_, hex.substr(0, 2), hex);
}

std::optional<std::string> BlobCache::Get(const Digest& digest) {
  const std::string path = PathOf(digest);
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  auto bytes = ReadFile(path, kSceneFileSizeMax);
  if (!bytes) return std::nullopt;
  if (Sha256(*bytes) != digest) {
    fs::remove(path, error);
    return std::nullopt;
  }
  fs::last_write_time(path, fs::file_time_type::clock::now(), error);  // marks the use
  return std::move(*bytes);
}

Result<void> BlobCache::Put(const Digest& digest, std::string_view bytes) {
  if (bytes.size() > bytes_max_) return {};
  bytes_ += bytes.size();
  if (bytes_ > bytes_max_) MakeRoomFor(bytes.size());
  const fs::path path = PathOf(digest);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const fs::path beside = fmt::format("{}{}{}-{}", path.string(), kTemporaryMark, ::getpid(), written_++);
  {
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) error = std::make_error_code(std::errc::io_error);
  }
  if (!error) fs::rename(beside, path, error);
  if (!error) return {};
  std::error_code ignored;
  fs::remove(beside, ignored);
  return Failed(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
}

bool BlobCache::Has(const Digest& digest, uint64_t size) const {
  std::error_code error;
  const uint64_t found = fs::file_size(PathOf(digest), error);
  return !error && found == size;
}

Result<std::unique_ptr<BlobCache::Incoming>> BlobCache::Begin(const Digest& digest, uint64_t size) {
  std::unique_ptr<Incoming> incoming(new Incoming);
  incoming->path_ = PathOf(digest);
  incoming->beside_ = fmt::format("{}{}part", incoming->path_, kTemporaryMark);
  incoming->digest_ = digest;
  std::error_code error;
  fs::create_directories(fs::path(incoming->path_).parent_path(), error);
  incoming->file_ = ::open(incoming->beside_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (incoming->file_ < 0) return Failed(fmt::format("{}: cannot be written", incoming->beside_));
  struct stat ours {};
  struct stat named {};
  // The name may have been taken from the file before it was locked: then it is whole by now.
  const bool is_ours = ::flock(incoming->file_, LOCK_EX | LOCK_NB) == 0 &&
                       ::fstat(incoming->file_, &ours) == 0 &&
                       ::stat(incoming->beside_.c_str(), &named) == 0 && ours.st_ino == named.st_ino;
  if (!is_ours) return std::unique_ptr<Incoming>();
  const bool too_long = static_cast<uint64_t>(ours.st_size) > size;
  if (too_long && ::ftruncate(incoming->file_, 0) != 0)
    return Failed(fmt::format("{}: cannot be truncated", incoming->beside_));
  std::string piece(kPieceBytes, '\0');
  ssize_t count = 0;
  while ((count = ::read(incoming->file_, piece.data(), piece.size())) > 0) {
    incoming->hash_.Add(std::string_view(piece).substr(0, static_cast<size_t>(count)));
    incoming->size_ += static_cast<uint64_t>(count);
  }
  bytes_ += size;
  if (bytes_ > bytes_max_) MakeRoomFor(size);
  return incoming;
}

BlobCache::Incoming::~Incoming() {
  if (file_ >= 0) ::close(file_);
}

Result<void> BlobCache::Incoming::Add(std::string_view bytes) {
  hash_.Add(bytes);
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count <= 0) return Failed(fmt::format("{}: cannot be written: {}", beside_, std::strerror(errno)));
    bytes.remove_prefix(static_cast<size_t>(count));
    size_ += static_cast<uint64_t>(count);
  }
  return {};
}

Result<void> BlobCache::Incoming::Finish() {
  if (hash_.Finish() != digest_) {
    ::unlink(beside_.c_str());
    return Failed("a file came damaged from the coordinator");
  }
  if (::rename(beside_.c_str(), path_.c_str()) != 0)
    return Failed(fmt::format("{}: cannot be written", path_));
  return {};
}

void BlobCache::MakeRoomFor(uint64_t bytes) {
  if (making_room_.exchange(true)) return;
  std::vector<CachedFile> files = ListFiles(folder_);
  uint64_t total = TotalSize(files) + bytes;
  std::ranges::sort(files, {}, &CachedFile::used);
  const uint64_t target = bytes_max_ - bytes_max_ / 10;  // some room, so that not every write has to look
  const auto stale = fs::file_time_type::clock::now() - kTemporaryAgeMax;
  for (const CachedFile& file : files) {
    const bool temporary = file.path.filename().string().find(kTemporaryMark) != std::string::npos;
    if (temporary ? file.used > stale : total <= target) continue;
    std::error_code error;
    fs::remove(file.path, error);
    total -= file.size;
  }
  bytes_ = total;
  making_room_ = false;
}

}  // namespace tessera
