#include "renderer/util/file_descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "renderer/util/file.h"

namespace tessera {

bool FileDescriptor::Close() {
  const int number = std::exchange(number_, -1);
  return number < 0 || ::close(number) == 0;
}

bool WriteAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return true;
}

Result<FileDescriptor> OpenNamelessFile(const std::string& folder) {
  std::string path = folder + "/nameless-XXXXXX";
  FileDescriptor file(::mkostemp(path.data(), O_CLOEXEC));
  if (!file) return SystemError(path, "cannot be created");
  ::unlink(path.c_str());
  return file;
}

}  // namespace tessera
