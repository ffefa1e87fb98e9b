#include "client/temporary_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "proto/shell/program.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr size_t kParentSizeMax = 60;  // bytes: the path of a socket has at most 107
constexpr const char* kPrefix = "tessera-local-";
constexpr time_t kFreshSeconds = 60;  // a folder that was just made may not be locked yet

void RemoveAll(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

// Returns a negative number if the folder cannot be locked.
int Lock(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder >= 0 && ::flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
  if (folder >= 0) ::close(folder);
  return -1;
}

// Removes folders of this user that no process uses any more.
void RemoveAbandoned(const std::string& parent) {
  const auto paths = ListFolder(parent);
  if (!paths) return;
  for (const std::string& path : *paths) {
    struct stat status {};
    const std::string name = std::filesystem::path(path).filename().string();
    if (!name.starts_with(kPrefix) || ::lstat(path.c_str(), &status) != 0) continue;
    const bool is_old = std::time(nullptr) - status.st_mtime > kFreshSeconds;
    if (!S_ISDIR(status.st_mode) || status.st_uid != ::geteuid() || !is_old) continue;
    const int lock = Lock(path);
    if (lock < 0) continue;
    RemoveAll(path);
    ::close(lock);
  }
}

}  // namespace

std::string TemporaryRoot() {
  const std::string set = Environment("TMPDIR");
  return set.starts_with('/') ? set : "/tmp";
}

Result<TemporaryFolder> TemporaryFolder::Make() {
  const std::string set = Environment("TMPDIR");
  const bool usable = set.starts_with('/') && set.size() <= kParentSizeMax;
  const std::string parent = usable ? set : "/tmp";
  RemoveAbandoned(parent);
  std::string path = fmt::format("{}/{}XXXXXX", parent, kPrefix);
  if (::mkdtemp(path.data()) == nullptr) {
    return Failed(fmt::format("{}: cannot create a temporary folder: {}", path, std::strerror(errno)));
  }
  const int lock = Lock(path);
  return TemporaryFolder(std::move(path), lock);
}

TemporaryFolder::~TemporaryFolder() {
  if (!path_.empty()) RemoveAll(path_);
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace tessera
