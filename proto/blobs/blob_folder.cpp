#include "proto/blobs/blob_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "renderer/util/file.h"

namespace tessera {

// proc(5): the entries of /proc/self/fd lead to what is open, not to what has its name. Without /proc the
// name has to do.
BlobFolder::BlobFolder(int descriptor, std::string name)
    : descriptor_(descriptor),
      name_(std::move(name)),
      location_(fmt::format("/proc/self/fd/{}", descriptor)) {
  if (::access(location_.c_str(), F_OK) != 0) location_ = name_;
}

BlobFolder::~BlobFolder() {
  ::close(descriptor_);
}

Result<std::shared_ptr<const BlobFolder>> BlobFolder::Open(const std::string& name) {
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return SystemError(name, "cannot be opened");
  return std::shared_ptr<const BlobFolder>(std::make_shared<BlobFolder>(descriptor, name));
}

std::string BlobFolder::Named(std::string text) const {
  if (location_ == name_) return text;
  const std::string prefix = location_ + "/";
  for (size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix, at + name_.size()))
    text.replace(at, location_.size(), name_);
  return text;
}

}  // namespace tessera
