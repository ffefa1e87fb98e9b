// The header of a PLY file (Turk 1994): which elements follow, of which properties, in which encoding.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

enum class PlyType : uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
size_t PlySize(PlyType type);  // in bytes, when binary
constexpr bool PlyIsInteger(PlyType type) {
  return type < PlyType::kFloat32;
}

enum class PlyFormat { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  // of a list
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // The smallest number of bytes that one of these takes.
  size_t SizeMin(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t data_offset = 0;  // of the first byte after the header
};

// `name` is the name of the file, for messages. Counts are those the file claims, not yet compared with the
// data.
Result<PlyHeader> ReadPlyHeader(std::string_view bytes, const std::string& name);

}  // namespace tessera
