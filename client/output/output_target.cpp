#include "client/output/output_target.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/fs.h>
#include <linux/magic.h>
#include <sys/ioctl.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>

#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr int kLinksMax = 40;  // in a row, as in the kernel (path_resolution(7))

// File systems without a constant in linux/magic.h on Debian 12.
constexpr uint32_t kNtfs3Magic = 0x7366746e;
constexpr uint32_t kHfsPlusMagic = 0x482b;

Error Refuse(const std::string& path, const std::string& why) {
  return BadInput(fmt::format("{}: {}", ShownPath(path), why));
}

std::string FolderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

std::string NameIn(const std::string& path) {
  return path.substr(path.rfind('/') + 1);  // npos + 1 is 0
}

bool IsInProc(const std::string& folder) {
  struct statfs system {};
  return ::statfs(folder.c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
}

// Whether names in the folder that differ in case alone name the same file.
bool IgnoresCase(const std::string& folder) {
  struct statfs system {};
  if (::statfs(folder.c_str(), &system) == 0) {
    constexpr uint32_t kIgnoring[] = {MSDOS_SUPER_MAGIC, EXFAT_SUPER_MAGIC, CIFS_SUPER_MAGIC,
                                      SMB2_SUPER_MAGIC,  kNtfs3Magic,       kHfsPlusMagic};
    if (std::ranges::find(kIgnoring, static_cast<uint32_t>(system.f_type)) != std::end(kIgnoring))
      return true;
  }
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  unsigned int flags = 0;  // the kernel writes an int, whatever the ioctl's number says
  const bool known = file >= 0 && ::ioctl(file, FS_IOC_GETFLAGS, &flags) == 0;
  if (file >= 0) ::close(file);
  return known && (flags & FS_CASEFOLD_FL) != 0;
}

// The number N of "/proc/self/fd/N", which /dev/stdout and /dev/fd/N lead to.
std::optional<int> DescriptorOf(const std::string& path) {
  std::error_code error;
  const auto folder = std::filesystem::canonical(FolderOf(path), error);
  const auto own = std::filesystem::canonical("/proc/self/fd", error);
  if (error || folder != own) return std::nullopt;
  const std::string name = NameIn(path);
  int number = -1;
  const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (wrong != std::errc() || end != name.data() + name.size() || number < 0) return std::nullopt;
  return number;
}

// The path that the links at `path` lead to, which may not exist. Stops at the links of /proc, which stand
// for open files and not for paths.
Result<std::string> FollowLinks(std::string path) {
  for (int count = 0; count < kLinksMax; ++count) {
    std::error_code error;
    const auto next = std::filesystem::read_symlink(path, error);
    if (error || IsInProc(FolderOf(path))) return path;
    path = next.is_absolute() ? next.string() : FolderOf(path) + "/" + next.string();
  }
  return Refuse(path, "too many links in a row");
}

Result<void> ExamineDescriptor(const std::string& path, OutputTarget& target) {
  target.kind = OutputTarget::Kind::kDescriptor;
  const int mode = ::fcntl(target.descriptor, F_GETFL);
  if (mode < 0 || ::fstat(target.descriptor, &target.status) != 0) return Refuse(path, "is not open");
  if ((mode & O_ACCMODE) == O_RDONLY) return Refuse(path, "is not open for writing");
  if (::isatty(target.descriptor) != 0)
    return Refuse(path,
                  "is a terminal, which cannot show the bytes of a picture; redirect it to a file or a pipe");
  return {};
}

Result<void> ExamineExisting(const std::string& path, OutputTarget& target) {
  const mode_t mode = target.status.st_mode;
  if (S_ISDIR(mode)) return Refuse(path, "is a folder");
  if (S_ISBLK(mode)) return Refuse(path, "is a disk or another block device");
  if (S_ISSOCK(mode)) return Refuse(path, "is a socket, which cannot be opened as a file");
  // The user root may write to every file, but a file without any write permission is protected on purpose.
  if ((mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0) return Refuse(path, "is read-only");
  if (::access(target.path.c_str(), W_OK) != 0)
    return Refuse(path, fmt::format("cannot be written: {}", std::strerror(errno)));
  target.kind = S_ISREG(mode) ? OutputTarget::Kind::kRegular : OutputTarget::Kind::kStream;
  return {};
}

Result<FileIdentity> IdentityOfNew(const std::string& path, const std::string& target) {
  const std::string folder = FolderOf(target);
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode))
    return Refuse(path, fmt::format("the folder {} does not exist", folder));
  FileIdentity identity{status.st_dev, status.st_ino, NameIn(target)};
  if (identity.name.empty()) return Refuse(path, "is not the name of a file");
  if (IgnoresCase(folder)) {
    for (char& c : identity.name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return identity;
}

}  // namespace

std::string OutputTarget::folder() const {
  return FolderOf(path);
}

std::string ShownPath(const std::string& path) {
  return path == kStandardOutput ? "the standard output" : path;
}

Result<OutputTarget> ExamineOutput(const std::string& path) {
  auto followed = FollowLinks(path);
  if (!followed) return followed.error();
  OutputTarget target;
  target.path = std::move(*followed);
  if (path == kStandardOutput) {
    target.descriptor = STDOUT_FILENO;
    if (auto good = ExamineDescriptor(path, target); !good) return good.error();
  } else if (const auto descriptor = DescriptorOf(target.path)) {
    target.descriptor = *descriptor;
    if (auto good = ExamineDescriptor(path, target); !good) return good.error();
  } else if (::stat(target.path.c_str(), &target.status) == 0) {
    if (auto good = ExamineExisting(path, target); !good) return good.error();
  } else {
    auto identity = IdentityOfNew(path, target.path);
    if (!identity) return identity.error();
    if (::access(target.folder().c_str(), W_OK) != 0)
      return Refuse(path, fmt::format("no permission to write to the folder {}", target.folder()));
    target.identity = std::move(*identity);
    return target;
  }
  target.identity = {target.status.st_dev, target.status.st_ino, ""};
  return target;
}

Result<FileIdentity> IdentityOfInput(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return SystemError(path, "cannot be examined");
  return FileIdentity{status.st_dev, status.st_ino, ""};
}

}  // namespace tessera
