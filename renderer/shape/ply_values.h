// Numbers one after the other from the body of a PLY file.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "renderer/description/number.h"
#include "renderer/shape/ply_header.h"

namespace tessera {

// Values in binary, bytes swapped if the file's order is not ours.
template <bool kSwap>
class PlyBinaryValues {
 public:
  explicit PlyBinaryValues(std::string_view bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {}

  size_t Remaining() const { return static_cast<size_t>(end_ - at_); }
  // Whether reading stopped at the end of the data rather than at an invalid value.
  bool AtEnd() const { return true; }

  // False if the data ends first.
  bool ReadFloat(PlyType type, float* value) {
    return WithType(type, [value](auto v) { *value = static_cast<float>(v); });
  }
  // `type` must be an integer type.
  bool ReadInteger(PlyType type, int64_t* value) {
    // NOLINTNEXTLINE(bugprone-signed-char-misuse): a PLY "char" is a signed number.
    return WithType(type, [value](auto v) { *value = static_cast<int64_t>(v); });
  }
  bool Skip(PlyType type, uint64_t count) {
    const size_t size = PlySize(type);
    if (count > Remaining() / size) return false;
    at_ += count * size;
    return true;
  }

 private:
  template <typename T, typename Use>
  bool Take(Use use) {
    if (Remaining() < sizeof(T)) return false;
    char bytes[sizeof(T)];
    for (size_t i = 0; i < sizeof(T); ++i) bytes[i] = at_[kSwap ? sizeof(T) - 1 - i : i];
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, bytes, sizeof value);
    use(value);
    return true;
  }
  template <typename Use>
  bool WithType(PlyType type, Use use) {
    switch (type) {
      case PlyType::kInt8: return Take<int8_t>(use);
      case PlyType::kUint8: return Take<uint8_t>(use);
      case PlyType::kInt16: return Take<int16_t>(use);
      case PlyType::kUint16: return Take<uint16_t>(use);
      case PlyType::kInt32: return Take<int32_t>(use);
      case PlyType::kUint32: return Take<uint32_t>(use);
      case PlyType::kFloat32: return Take<float>(use);
      case PlyType::kFloat64: return Take<double>(use);
    }
    return false;
  }

  const char* at_;
  const char* end_;
};

// Values as words between white space.
class PlyAsciiValues {
 public:
  explicit PlyAsciiValues(std::string_view bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {}

  size_t Remaining() const { return static_cast<size_t>(end_ - at_); }
  bool AtEnd() {
    SkipSpace();
    return at_ == end_;
  }

  // False if the next word is not a number, or there is none.
  bool ReadFloat(PlyType type, float* value) {
    if (type != PlyType::kFloat64) return Read(value);
    double wide = 0;  // rounded twice, as the same number in binary
    if (!Read(&wide)) return false;
    *value = static_cast<float>(wide);
    return true;
  }
  bool ReadInteger(PlyType, int64_t* value) { return Read(value); }
  bool Skip(PlyType, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) {
      SkipSpace();
      if (at_ == end_) return false;
      while (at_ != end_ && !IsSpace(*at_)) ++at_;
    }
    return true;
  }

 private:
  static bool IsSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  void SkipSpace() {
    while (at_ != end_ && IsSpace(*at_)) ++at_;
  }
  template <typename T>
  bool Read(T* value) {
    SkipSpace();
    const auto [stop, error] = ReadNumber(at_, end_, *value);
    if (error != std::errc() || (stop != end_ && !IsSpace(*stop))) return false;
    at_ = stop;
    return true;
  }

  const char* at_;
  const char* end_;
};

}  // namespace tessera
