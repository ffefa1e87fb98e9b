// A file in memory that has a path.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "renderer/util/check.h"

namespace tessera {

class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("tessera_fuzz", MFD_CLOEXEC)) { TESSERA_CHECK(file_ >= 0); }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }
  void Fill(std::string_view bytes) const {
    TESSERA_CHECK(::ftruncate(file_, 0) == 0);
    TESSERA_CHECK(::pwrite(file_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  }

 private:
  int file_;
};

}  // namespace tessera
