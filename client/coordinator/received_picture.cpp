#include "client/coordinator/received_picture.h"

#include <sys/mman.h>

#include <utility>

#include "renderer/util/file.h"

namespace tessera {

ReceivedPicture::ReceivedPicture(std::string folder, size_t held_max)
    : folder_(std::move(folder)), held_max_(held_max) {}

void ReceivedPicture::Unmap::operator()(char* bytes) const {
  ::munmap(bytes, size);
}

Result<void> ReceivedPicture::Add(std::string_view bytes) {
  if (is_in_memory() && held_.size() + bytes.size() <= held_max_) {
    held_ += bytes;
    size_ = held_.size();
    return {};
  }
  if (is_in_memory()) {
    auto file = OpenNamelessFile(folder_);
    if (!file) return file.error();
    file_ = std::move(*file);
    if (!WriteAll(file_.number(), held_)) return SystemError(folder_, "a picture cannot be written there");
    held_ = {};
  }
  if (!WriteAll(file_.number(), bytes)) return SystemError(folder_, "a picture cannot be written there");
  size_ += bytes.size();
  return {};
}

Result<std::string_view> ReceivedPicture::Bytes() {
  if (is_in_memory()) return std::string_view(held_);
  if (map_ == nullptr) {
    void* const bytes = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file_.number(), 0);
    if (bytes == MAP_FAILED) return SystemError(folder_, "a picture there cannot be read");
    map_ = {static_cast<char*>(bytes), Unmap{size_}};
  }
  return std::string_view(map_.get(), size_);
}

}  // namespace tessera
