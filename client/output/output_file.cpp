#include "client/output/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstring>
#include <random>

#include "client/output/output_target.h"
#include "proto/shell/pause.h"
#include "renderer/util/file_descriptor.h"

namespace tessera {
namespace {

constexpr mode_t kNewFileMode = 0666;  // the umask takes its part
constexpr std::chrono::milliseconds kReaderProbe{50};
constexpr int kStopProbe_ms = 100;
constexpr int kTemporaryNamesMax = 100;  // attempts to find a free name
constexpr size_t kWriteMax = size_t{1} << 20;

Error CannotWrite(const std::string& path, int reason) {
  return Failed(fmt::format("{}: cannot be written: {}", ShownPath(path), std::strerror(reason)));
}

// Makes the names in a folder durable. Some file systems cannot, which is no reason to fail.
void Sync(const std::string& folder) {
  const FileDescriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file) ::fsync(file.number());
}

// A new file beside the target. It is removed unless Publish renames it.
class TemporaryFile {
 public:
  // errno holds the reason if the file is not open afterwards.
  explicit TemporaryFile(const OutputTarget& target) : file_(Create(target)) {}
  ~TemporaryFile() {
    const int reason = errno;
    if (file_ || is_written_) ::unlink(path_.c_str());
    errno = reason;
  }
  explicit operator bool() const { return static_cast<bool>(file_); }
  int number() const { return file_.number(); }
  bool Write(std::string_view bytes) {
    is_written_ = true;
    return WriteAll(number(), bytes) && ::fsync(number()) == 0 && file_.Close();
  }
  // With kKeep, fails with EEXIST if there is a file meanwhile.
  bool Publish(const OutputTarget& target, Existing existing) {
    const bool keeps = existing == Existing::kKeep;
    int failed =
        ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target.path.c_str(), keeps ? RENAME_NOREPLACE : 0);
    // Some network file systems know no flags. There, links do not replace files either.
    if (failed != 0 && keeps && errno == EINVAL) {
      failed = ::link(path_.c_str(), target.path.c_str());
      if (failed == 0) ::unlink(path_.c_str());
    }
    if (failed != 0) return false;
    is_written_ = false;
    return true;
  }

 private:
  // The name does not contain the target's, which may be as long as names can be.
  int Create(const OutputTarget& target) {
    std::random_device random;
    int file = -1;
    for (int i = 0; i < kTemporaryNamesMax && file < 0; ++i) {
      path_ = fmt::format("{}/.tessera-{:08x}.tmp", target.folder(), random());
      const mode_t mode = target.kind == OutputTarget::Kind::kNew ? kNewFileMode : 0600;
      file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
      if (file < 0 && errno != EEXIST) break;
    }
    return file;
  }

  std::string path_;
  FileDescriptor file_;
  bool is_written_ = false;
};

// Gives the file the mode and owner of what it replaces. Returns false if this user may not.
bool TakeOver(int file, const struct stat& status) {
  struct stat own {};
  if (::fstat(file, &own) != 0) return false;
  if ((own.st_uid != status.st_uid || own.st_gid != status.st_gid) &&
      ::fchown(file, status.st_uid, status.st_gid) != 0)
    return false;
  return ::fchmod(file, status.st_mode & ALLPERMS) == 0;
}

Result<void> WriteInPlace(const std::string& path, const OutputTarget& target, std::string_view bytes) {
  FileDescriptor file(::open(target.path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file || !WriteAll(file.number(), bytes) ||
      ::ftruncate(file.number(), static_cast<off_t>(bytes.size())) != 0 || ::fsync(file.number()) != 0 ||
      !file.Close())
    return CannotWrite(path, errno);
  return {};
}

// Writes a regular file, new or not.
Result<void> WriteWhole(const std::string& path, const OutputTarget& target, std::string_view bytes,
                        Existing existing) {
  const bool exists = target.kind == OutputTarget::Kind::kRegular;
  if (exists && existing == Existing::kKeep) return ExistsAlready(path);
  if (exists && target.status.st_nlink > 1) return WriteInPlace(path, target, bytes);
  {
    TemporaryFile file(target);
    if (!file && !exists) return CannotWrite(path, errno);
    if (file && (!exists || TakeOver(file.number(), target.status))) {
      if (!file.Write(bytes)) return CannotWrite(path, errno);
      if (file.Publish(target, existing)) {
        Sync(target.folder());
        return {};
      }
      if (existing == Existing::kKeep && errno == EEXIST) return ExistsAlready(path);
      // A file that is mounted by itself cannot be replaced (EBUSY).
      if (!exists || errno != EBUSY) return CannotWrite(path, errno);
    }
  }
  return WriteInPlace(path, target, bytes);
}

Error Interrupted() {
  return {ErrorKind::kInterrupted, "interrupted"};
}

// Opens a pipe or device. Waits until a pipe has a reader.
Result<int> OpenStream(const std::string& path, const OutputTarget& target, std::stop_token stop) {
  while (true) {
    const int file = ::open(target.path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file >= 0) return file;
    if (errno != ENXIO || !S_ISFIFO(target.status.st_mode)) return CannotWrite(path, errno);
    if (!Pause(stop, kReaderProbe)) return Interrupted();
  }
}

// Writes to a descriptor that may be slow to take the bytes.
Result<void> WriteStream(const std::string& path, int descriptor, std::string_view bytes,
                         std::stop_token stop) {
  struct stat status {};
  const bool is_file = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  // A pipe that poll reports as writable takes PIPE_BUF bytes without blocking.
  const size_t piece_max = is_file ? kWriteMax : PIPE_BUF;
  while (!bytes.empty()) {
    if (stop.stop_requested()) return Interrupted();
    pollfd event{descriptor, POLLOUT, 0};
    if (::poll(&event, 1, kStopProbe_ms) == 0) continue;
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), piece_max));
    if (written < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (written <= 0) return CannotWrite(path, errno);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return {};
}

}  // namespace

Error ExistsAlready(const std::string& path) {
  return BadInput(fmt::format("{}: exists already, and --no-clobber keeps it", ShownPath(path)));
}

Result<void> WriteOutput(const std::string& path, std::string_view bytes, std::stop_token stop,
                         Existing existing) {
  const auto target = ExamineOutput(path);
  if (!target) return target.error();
  switch (target->kind) {
    case OutputTarget::Kind::kNew:
    case OutputTarget::Kind::kRegular: return WriteWhole(path, *target, bytes, existing);
    case OutputTarget::Kind::kDescriptor: return WriteStream(path, target->descriptor, bytes, stop);
    case OutputTarget::Kind::kStream: break;
  }
  const auto opened = OpenStream(path, *target, stop);
  if (!opened) return opened.error();
  FileDescriptor file(*opened);
  if (auto written = WriteStream(path, file.number(), bytes, stop); !written) return written;
  if (!file.Close()) return CannotWrite(path, errno);
  return {};
}

bool IsStandardOutput(const std::string& path) {
  const auto target = ExamineOutput(path);
  return target && target->kind == OutputTarget::Kind::kDescriptor && target->descriptor == STDOUT_FILENO;
}

}  // namespace tessera
