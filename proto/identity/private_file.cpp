#include "proto/identity/private_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "proto/identity/private_key.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr mode_t kFileMode = 0600;
constexpr mode_t kFolderMode = 0700;
constexpr mode_t kOthers = 0077;

}  // namespace

Result<std::string> ReadPrivateFile(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return SystemError(path, "cannot be examined");
  // Root may hand secrets of its own to a service.
  if (status.st_uid != ::geteuid() && status.st_uid != 0)
    return Failed(
        fmt::format("{}: belongs to another user (uid {}), who could change it", path, status.st_uid));
  if ((status.st_mode & kOthers) != 0) {
    return Failed(fmt::format("{}: other users may read or change it (mode {:o}); run: chmod 600 {}", path,
                              status.st_mode & 07777, path));
  }
  return ReadFile(path, kPemBytesMax);
}

Result<void> WritePrivateFile(const std::string& path, std::string_view bytes) {
  return WriteFileAtomically(path, bytes, kFileMode);
}

Result<void> PreparePrivateFolder(const std::string& path) {
  const size_t slash = path.find_last_of('/');
  if (slash != std::string::npos && slash > 0) {
    if (auto made = CreateFolders(path.substr(0, slash)); !made) return made;
  }
  if (::mkdir(path.c_str(), kFolderMode) != 0 && errno != EEXIST)
    return SystemError(path, "cannot be created");
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return SystemError(path, "cannot be examined");
  if (!S_ISDIR(status.st_mode)) return Failed(fmt::format("{}: is a link or a file, not a folder", path));
  if (status.st_uid != ::geteuid())
    return Failed(fmt::format("{}: belongs to another user (uid {})", path, status.st_uid));
  if ((status.st_mode & kOthers) != 0 && ::chmod(path.c_str(), kFolderMode) != 0)
    return SystemError(path, "cannot be made private");
  return {};
}

}  // namespace tessera
