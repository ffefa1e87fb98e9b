// OpenEXR files in memory.
#pragma once

#include <ImfIO.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace tessera {

// Collects what OpenEXR writes.
class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("picture in memory") {}
  void write(const char bytes[], int count) override {
    const size_t end = position_ + static_cast<size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, bytes, static_cast<size_t>(count));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t position_ = 0;
};

// Gives OpenEXR bytes in memory to read.
class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::string_view bytes) : Imf::IStream("picture in memory"), bytes_(bytes) {}
  bool read(char bytes[], int count) override {
    const auto wanted = static_cast<size_t>(count);
    if (position_ > bytes_.size() || wanted > bytes_.size() - position_)
      throw std::runtime_error("unexpected end of file");
    std::memcpy(bytes, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  size_t position_ = 0;
};

}  // namespace tessera
