// Files that are open, by their descriptors.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "renderer/util/result.h"

namespace tessera {

// Owns a descriptor, or none if it is negative.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor() { Close(); }
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }
  // Returns false, with the reason in errno, if the system could not write what it held back. The descriptor
  // is closed all the same.
  bool Close();

 private:
  int number_;
};

// Returns false, with the reason in errno, if not all bytes could be written.
bool WriteAll(int descriptor, std::string_view bytes);

// A new file in the folder to write and read, which has no name and vanishes when it is closed.
Result<FileDescriptor> OpenNamelessFile(const std::string& folder);

}  // namespace tessera
