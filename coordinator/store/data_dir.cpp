#include "coordinator/store/data_dir.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <optional>
#include <vector>

#include "proto/shell/pause.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr std::string_view kDataVersion = "tessera-data 6\n";
// Older directories are read. Version 4: the journal and spool have forms that are no longer written. Version
// 5: spool files that name no scene are not bound to one.
constexpr std::string_view kOlderDataVersions[] = {"tessera-data 4\n", "tessera-data 5\n"};

bool IsOlder(std::string_view version) {
  return std::ranges::find(kOlderDataVersions, version) != std::end(kOlderDataVersions);
}

// A process that was killed holds its locks until the kernel has freed its memory, which takes a moment after
// its parent, or a supervisor, knows that it has ended.
constexpr int kLockAttemptsMax = 40;
constexpr std::chrono::milliseconds kLockInterval{50};

// Returns false, with errno, if another process keeps the lock for all attempts.
bool TakeLock(int file) {
  for (int attempt = 1; ::flock(file, LOCK_EX | LOCK_NB) != 0; ++attempt) {
    if (errno != EWOULDBLOCK || attempt == kLockAttemptsMax) return false;
    Pause({}, kLockInterval);
  }
  return true;
}

// For the records that follow a job's.
constexpr uint64_t kSpaceMin = uint64_t{64} << 10;
// What is being sent leaves this part of the disk free, and at most this many bytes: half of what scene files
// leave, so that there is room for it on a disk that they fill.
constexpr uint64_t kSendingReserveDivisor = 40, kSendingReserveMax = uint64_t{1} << 29;

struct Space {
  uint64_t total = 0, free = 0;  // bytes
};

// Returns nullopt if it is not known.
std::optional<Space> SpaceOf(const std::string& path) {
  struct statvfs space {};
  if (::statvfs(path.c_str(), &space) != 0) return std::nullopt;
  return Space{uint64_t{space.f_blocks} * space.f_frsize, uint64_t{space.f_bavail} * space.f_frsize};
}

Result<void> CheckVersion(const std::string& path) {
  const std::string file = path + "/version";
  if (!std::filesystem::exists(file)) return {};
  const auto version = ReadFile(file, 1024);
  if (!version) return version.error();
  if (*version == kDataVersion || IsOlder(*version)) return {};
  return Failed(fmt::format(
      "{}: was created by another version of tessera-coordinator (found \"{}\", expected \"{}\"); "
      "finish its jobs with that version or use another --data-dir",
      path, version->substr(0, version->find('\n')), kDataVersion.substr(0, kDataVersion.size() - 1)));
}

Result<void> CheckJournal(const std::string& path) {
  if (!std::filesystem::exists(path + "/version") || std::filesystem::exists(path + "/journal")) return {};
  return Failed(
      fmt::format("{}: its journal is missing, so the jobs that it had are not known; put the journal back, "
                  "or forget these "
                  "jobs and their results with --start-afresh",
                  path));
}

// Files that were being written when a process ended do not have their final names yet.
void RemoveHalfWritten(const std::string& path) {
  std::vector<std::string> half_written;
  const auto paths = ListFolder(path);
  for (const std::string& each : paths ? *paths : std::vector<std::string>()) {
    if (each.ends_with(".tmp") || each.ends_with(".new")) half_written.push_back(each);
  }
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(path + "/pictures", error), end; !error && it != end;
       it.increment(error)) {
    if (it->path().extension() == ".tmp") half_written.push_back(it->path().string());
  }
  for (const std::string& file : half_written) std::filesystem::remove(file, error);
}

}  // namespace

Result<DataDir> DataDir::Open(const std::string& path, Journal journal) {
  if (const auto made = CreateFolders(path); !made) return made.error();
  DataDir directory(path);
  if (const auto locked = directory.Lock(); !locked) return locked.error();
  if (const auto checked = CheckVersion(path); !checked) return checked.error();
  if (journal == Journal::kRequired) {
    if (const auto checked = CheckJournal(path); !checked) return checked.error();
  }
  for (const char* folder : {"/blobs", "/pictures"}) {
    if (const auto made = CreateFolders(path + folder); !made) return made.error();
  }
  RemoveHalfWritten(path);
  return directory;
}

// The folder itself is locked, because a file in it could be removed and created again by another process.
Result<void> DataDir::Lock() {
  folder_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0) return SystemError(path_, "cannot be opened");
  const std::string file =
      path_ + "/lock";  // of file systems that cannot lock folders, and of older releases
  const bool is_taken = !TakeLock(folder_) && errno == EWOULDBLOCK;
  if (!is_taken) {
    lock_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (lock_ < 0) return SystemError(file, "cannot be opened");
  }
  if (is_taken || !TakeLock(lock_))
    return Failed(fmt::format("{}: another tessera-coordinator is using this data directory", path_));
  if (::fchmod(folder_, 0700) != 0) return SystemError(path_, "cannot be made private");
  return {};
}

bool DataDir::is_older() const {
  const auto version = ReadFile(path_ + "/version", 1024);
  return version && IsOlder(*version);
}

Result<void> DataDir::MarkUsed() const {
  const std::string file = path_ + "/version";
  const auto version = ReadFile(file, 1024);
  return version && *version == kDataVersion ? Result<void>() : WriteFileAtomically(file, kDataVersion);
}

Result<void> DataDir::CheckSpace(uint64_t bytes) const {
  const auto space = SpaceOf(path_);
  if (!space || bytes + kSpaceMin <= space->free) return {};
  return Failed(
      fmt::format("{}: No space left on device: the file system of the coordinator's data has {} bytes left; "
                  "free some space there and try again",
                  path_, space->free));
}

Result<ReadableFile> DataDir::KeepForSending(std::string_view bytes) const {
  if (const auto space = SpaceOf(path_)) {
    const uint64_t reserve = std::min(space->total / kSendingReserveDivisor, kSendingReserveMax);
    if (bytes.size() + reserve > space->free) {
      return Failed(fmt::format(
          "{}: no room for a copy of {} bytes to send: the file system of the coordinator's data has {} "
          "bytes left, of which {} are reserved for the journal and for results; free some space there and "
          "try again",
          path_, bytes.size(), space->free, reserve));
    }
  }
  return ReadableFile::Nameless(path_, bytes);
}

DataDir::DataDir(DataDir&& other) noexcept
    : path_(std::move(other.path_)),
      folder_(std::exchange(other.folder_, -1)),
      lock_(std::exchange(other.lock_, -1)) {}

DataDir::~DataDir() {
  for (const int file : {lock_, folder_}) {
    if (file >= 0) ::close(file);  // unlocks
  }
}

}  // namespace tessera
