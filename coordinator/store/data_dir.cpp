#include "coordinator/store/data_dir.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr std::string_view kDataVersion = "tessera-data 5\n";
// Directories of version 4 are read: their journal and spool have forms that are read but no longer written.
constexpr std::string_view kOldestDataVersion = "tessera-data 4\n";

Result<void> MakeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return Failed(fmt::format("{}: cannot be created: {}", path, error.message()));
  return {};
}

Result<void> CheckVersion(const std::string& path) {
  const std::string file = path + "/version";
  if (!std::filesystem::exists(file)) return WriteFileAtomically(file, kDataVersion);
  const auto version = ReadFile(file, 1024);
  if (!version) return version.error();
  if (*version == kOldestDataVersion) return WriteFileAtomically(file, kDataVersion);
  if (*version != kDataVersion) {
    return Failed(fmt::format(
        "{}: was created by another version of tessera-coordinator (found \"{}\", expected \"{}\"); "
        "finish its jobs with that version or use another --data-dir",
        path, version->substr(0, version->find('\n')), kDataVersion.substr(0, kDataVersion.size() - 1)));
  }
  return {};
}

// Files that were being written when a process ended do not have their final names yet.
void RemoveHalfWritten(const std::string& path) {
  std::vector<std::filesystem::path> half_written;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path, error)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".tmp") || name.ends_with(".new")) half_written.push_back(entry.path());
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path + "/pictures", error)) {
    if (entry.path().extension() == ".tmp") half_written.push_back(entry.path());
  }
  for (const auto& file : half_written) std::filesystem::remove(file, error);
}

}  // namespace

Result<DataDir> DataDir::Open(const std::string& path) {
  for (const char* folder : {"", "/blobs", "/pictures"}) {
    if (const auto made = MakeFolder(path + folder); !made) return made.error();
  }
  const std::string file = path + "/lock";
  const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock < 0) return Failed(fmt::format("{}: cannot be opened: {}", file, std::strerror(errno)));
  DataDir directory(path, lock);
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    return Failed(fmt::format("{}: another tessera-coordinator is using this data directory", path));
  }
  if (const auto checked = CheckVersion(path); !checked) return checked.error();
  RemoveHalfWritten(path);
  return directory;
}

DataDir::DataDir(DataDir&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

DataDir::~DataDir() {
  if (lock_ >= 0) ::close(lock_);  // unlocks
}

}  // namespace tessera
