#include "renderer/util/readable_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "renderer/util/file.h"

namespace tessera {
namespace {

bool IsShortage(int reason) {
  return reason == EMFILE || reason == ENFILE || reason == ENOMEM;
}

}  // namespace

Result<ReadableFile> ReadableFile::Open(const std::string& path) {
  // Not blocking: a pipe must be refused, not waited for.
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file) {
    const ErrorKind kind = IsShortage(errno) ? ErrorKind::kFailed : ErrorKind::kBadInput;
    return Error{kind, fmt::format("{}: cannot be opened: {}", path, std::strerror(errno))};
  }
  struct stat status {};
  if (::fstat(file.number(), &status) != 0) return SystemError(path, "cannot be examined");
  if (!S_ISREG(status.st_mode)) return BadInput(fmt::format("{}: is not a regular file", path));
  return ReadableFile(std::move(file), static_cast<uint64_t>(status.st_size));
}

Result<ReadableFile> ReadableFile::Nameless(const std::string& folder, std::string_view bytes) {
  auto file = OpenNamelessFile(folder);
  if (!file) return file.error();
  if (!WriteAll(file->number(), bytes)) return SystemError(folder, "has no room for a copy");
  return ReadableFile(std::move(*file), bytes.size());
}

Result<void> ReadableFile::Read(uint64_t at, std::string& bytes) const {
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t size =
        ::pread(file_.number(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return Failed(std::strerror(errno));
    if (size == 0) break;
    done += static_cast<size_t>(size);
  }
  bytes.resize(done);
  return {};
}

}  // namespace tessera
