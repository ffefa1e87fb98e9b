// A picture as it arrives from a coordinator: its first bytes in memory, and the whole in a file without a
// name if it is large. So what a client holds does not depend on what a coordinator sends. Not thread safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "renderer/util/file_descriptor.h"
#include "renderer/util/result.h"

namespace tessera {

// Larger than most pictures, and little for a machine that looks at them.
constexpr size_t kPictureHeldMax = size_t{64} << 20;

class ReceivedPicture {
 public:
  // A picture of more than `held_max` bytes goes to a file in the folder, which is gone with this object.
  explicit ReceivedPicture(std::string folder, size_t held_max = kPictureHeldMax);

  // The error names the folder if the file cannot be written.
  Result<void> Add(std::string_view bytes);
  uint64_t size() const { return size_; }
  bool is_in_memory() const { return !file_; }
  // Everything that was added. Nothing is added after it. Valid while this object neither moves nor ends.
  Result<std::string_view> Bytes();

 private:
  struct Unmap {
    size_t size;
    void operator()(char* bytes) const;
  };
  std::string folder_;
  size_t held_max_;
  std::string held_;
  FileDescriptor file_;
  uint64_t size_ = 0;
  std::unique_ptr<char, Unmap> map_;  // of the file
};

}  // namespace tessera
