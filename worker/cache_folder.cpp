#include "worker/cache_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "renderer/util/file.h"

namespace tessera {
namespace {

// Groups may: a cache of an earlier release has the mode that the umask gave it.
constexpr mode_t kOthersMayWrite = 0002;
constexpr mode_t kPrivate = 0700;

// The first folder of a list as systemd sets it.
std::string FirstOf(const std::string& folders) {
  return folders.substr(0, folders.find(':'));
}

}  // namespace

std::string DefaultCacheFolder(const ReadEnvironment& environment) {
  if (const std::string cache = environment("XDG_CACHE_HOME"); !cache.empty()) return cache + "/tessera";
  if (const std::string cache = FirstOf(environment("CACHE_DIRECTORY")); !cache.empty()) return cache;
  if (const std::string home = environment("HOME"); !home.empty()) return home + "/.cache/tessera";
  if (const std::string state = FirstOf(environment("STATE_DIRECTORY")); !state.empty())
    return state + "/cache";
  const std::string temporary = environment("TMPDIR");
  return fmt::format("{}/tessera-cache-{}", temporary.empty() ? "/tmp" : temporary, ::geteuid());
}

Result<std::shared_ptr<const BlobFolder>> OpenCacheFolder(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::absolute(path).lexically_normal().parent_path();
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  if (error) return Failed(fmt::format("{}: cannot be created: {}", parent.string(), error.message()));
  if (::mkdir(path.c_str(), kPrivate) != 0 && errno != EEXIST) return SystemError(path, "cannot be created");
  // In a shared folder such as /tmp, a link could lead to any folder of this user.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0 && (errno == ENOTDIR || errno == ELOOP))
    return Failed(fmt::format("{}: is a link or a file; choose a folder with --cache-dir", path));
  if (descriptor < 0) return SystemError(path, "cannot be opened");
  auto folder = std::make_shared<const BlobFolder>(descriptor, path);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return SystemError(path, "cannot be examined");
  if (status.st_uid != ::geteuid()) {
    return Failed(fmt::format("{}: belongs to another user (uid {}); choose another folder with --cache-dir",
                              path, status.st_uid));
  }
  if ((status.st_mode & kOthersMayWrite) != 0) {
    return Failed(fmt::format(
        "{}: other users may have written to it (mode {:o}); remove it or choose another with --cache-dir",
        path, status.st_mode & 07777));
  }
  if (::fchmod(descriptor, kPrivate) != 0) return SystemError(path, "cannot be made private");
  return folder;
}

}  // namespace tessera
