// Little-endian bytes of values, for what lasts on disk. A reader never runs over the end: after the first
// miss all it gives is zero, and ok() says so.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tessera {

class ByteWriter {
 public:
  void Add32(uint32_t value) { AddBytes(value, 4); }
  void Add64(uint64_t value) { AddBytes(value, 8); }
  void AddText(std::string_view text) {
    Add64(text.size());
    bytes_ += text;
  }
  std::string Take() { return std::move(bytes_); }

 private:
  void AddBytes(uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_.push_back(static_cast<char>(value >> (8 * i)));
  }
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
  uint32_t Read32() { return static_cast<uint32_t>(ReadBytes(4)); }
  uint64_t Read64() { return ReadBytes(8); }
  std::string ReadText() {
    const uint64_t size = Read64();
    if (size > rest_.size()) return Miss();
    std::string text(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return text;
  }
  // How many of a list follow, each of at least `each_min` bytes: a damaged count does not make anyone
  // reserve memory.
  uint64_t ReadCount(uint64_t each_min) {
    const uint64_t count = Read64();
    if (count <= rest_.size() / each_min) return count;
    Miss();
    return 0;
  }
  bool ok() const { return ok_; }
  bool at_end() const { return rest_.empty(); }

 private:
  uint64_t ReadBytes(size_t count) {
    if (rest_.size() < count) {
      Miss();
      return 0;
    }
    uint64_t value = 0;
    for (size_t i = 0; i < count; ++i) value |= uint64_t{static_cast<unsigned char>(rest_[i])} << (8 * i);
    rest_.remove_prefix(count);
    return value;
  }
  std::string Miss() {
    ok_ = false;
    rest_ = {};
    return {};
  }
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace tessera
