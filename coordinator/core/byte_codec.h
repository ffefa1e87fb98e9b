// Little-endian bytes of values, for what lasts on disk. A reader never reads past the end: after the first
// attempt everything it returns is zero or empty, and ok() is false.
//
// A versioned record is what can change without rejecting old data:
//   32-bit  version of the writer's record
//   32-bit  readable by: the lowest version whose readers may ignore what they do not know of it
//   64-bit  length, then that many bytes: the members of version 1, then those that version 2 added, ...
// A reader takes the members that it knows. What an older record lacks gets a default; what a newer one adds
// is ignored if the record says that it may be, otherwise the record is refused.
#pragma once

#include <cstdint>
#include <optional>
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
  void AddRecord(uint32_t version, uint32_t readable_by, std::string_view body) {
    Add32(version);
    Add32(readable_by);
    AddText(body);
  }
  std::string Take() { return std::move(bytes_); }

 private:
  void AddBytes(uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_.push_back(static_cast<char>(value >> (8 * i)));
  }
  std::string bytes_;
};

struct VersionedRecord;

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
  uint32_t Read32() { return static_cast<uint32_t>(ReadBytes(4)); }
  uint64_t Read64() { return ReadBytes(8); }
  std::string ReadText() { return std::string(ReadView()); }
  // nullopt if there is none, or if readers of `known_version` may not read it.
  std::optional<VersionedRecord> ReadRecord(uint32_t known_version);
  // The length of a list whose entries have at least `each_min` bytes: 0 if the rest cannot hold it, so a
  // damaged length makes nobody reserve memory.
  uint64_t ReadCount(uint64_t each_min) {
    const uint64_t count = Read64();
    if (count <= rest_.size() / each_min) return count;
    Fail();
    return 0;
  }
  bool ok() const { return ok_; }
  bool at_end() const { return rest_.empty(); }

 private:
  uint64_t ReadBytes(size_t count) {
    if (rest_.size() < count) {
      Fail();
      return 0;
    }
    uint64_t value = 0;
    for (size_t i = 0; i < count; ++i) value |= uint64_t{static_cast<unsigned char>(rest_[i])} << (8 * i);
    rest_.remove_prefix(count);
    return value;
  }
  std::string_view ReadView() {
    const uint64_t size = Read64();
    if (size > rest_.size()) {
      Fail();
      return {};
    }
    const std::string_view view = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return view;
  }
  void Fail() {
    ok_ = false;
    rest_ = {};
  }
  std::string_view rest_;
  bool ok_ = true;
};

struct VersionedRecord {
  uint32_t version = 0;
  ByteReader body;
  // Whether a reader that knows members up to `known_version` has read all of them, and nothing is left but
  // what a newer version added.
  bool IsReadBy(uint32_t known_version) const {
    return body.ok() && (body.at_end() || version > known_version);
  }
};

inline std::optional<VersionedRecord> ByteReader::ReadRecord(uint32_t known_version) {
  const uint32_t version = Read32();
  const uint32_t readable_by = Read32();
  const std::string_view body = ReadView();
  if (!ok_ || version == 0 || readable_by > known_version || readable_by > version) return std::nullopt;
  return VersionedRecord{version, ByteReader(body)};
}

}  // namespace tessera
