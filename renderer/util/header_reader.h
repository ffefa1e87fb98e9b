// Integers and texts one after the other from the bytes of a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace tessera {

// Every function returns nullopt (or false) and reads nothing if too few bytes are left. `bytes` must outlive
// the reader.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view bytes) : bytes_(bytes) {}

  size_t position() const { return at_; }
  std::string_view Rest() const { return bytes_.substr(at_); }

  std::optional<std::string_view> Take(uint64_t count) {
    if (count > bytes_.size() - at_) return std::nullopt;
    const std::string_view taken = bytes_.substr(at_, static_cast<size_t>(count));
    at_ += taken.size();
    return taken;
  }
  bool SkipBytes(uint64_t count) { return Take(count).has_value(); }

  // Least significant byte first, or most significant first.
  std::optional<uint32_t> Little(int size) { return Integer(size, true); }
  std::optional<uint32_t> Big(int size) { return Integer(size, false); }
  std::optional<uint32_t> Little32() { return Little(4); }
  std::optional<uint32_t> Integer(int size, bool is_little) {
    const std::optional<std::string_view> taken = Take(static_cast<uint64_t>(size));
    if (!taken) return std::nullopt;
    uint32_t value = 0;
    for (int i = 0; i < size; ++i) {
      const auto byte = static_cast<uint8_t>((*taken)[static_cast<size_t>(is_little ? size - 1 - i : i)]);
      value = value << 8 | byte;
    }
    return value;
  }

  // Up to the next zero byte, which is skipped.
  std::optional<std::string_view> ZeroEnded() {
    const size_t end = bytes_.find('\0', at_);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return text;
  }

 private:
  std::string_view bytes_;
  size_t at_ = 0;
};

}  // namespace tessera
