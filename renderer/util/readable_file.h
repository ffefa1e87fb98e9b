// A file whose bytes are read in pieces, so that it never is in memory as a whole.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "renderer/util/file_descriptor.h"
#include "renderer/util/result.h"

namespace tessera {

// Stays readable when its name is removed or given to another file. Any thread may read it.
class ReadableFile {
 public:
  // A regular file. An error that names the path if it cannot be opened or is none; kFailed, rather than
  // kBadInput, if the system lacks descriptors or memory for it.
  static Result<ReadableFile> Open(const std::string& path);
  // A new file that holds these bytes, has no name, and is gone when it is closed. An error if the folder has
  // no room for it.
  static Result<ReadableFile> Nameless(const std::string& folder, std::string_view bytes);

  ReadableFile(FileDescriptor file, uint64_t size) : file_(std::move(file)), size_(size) {}
  uint64_t size() const { return size_; }
  // Fills `bytes` from this position of the file on, and shortens them if it has fewer: it was cut. An error,
  // without the path, if it cannot be read.
  Result<void> Read(uint64_t at, std::string& bytes) const;

 private:
  FileDescriptor file_;
  uint64_t size_;
};

}  // namespace tessera
