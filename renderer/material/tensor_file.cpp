#include "renderer/material/tensor_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "renderer/description/source_location.h"
#include "renderer/util/header_reader.h"

namespace tessera {
namespace {

constexpr std::string_view kMagic("tensor_file\0", 12);
constexpr uint32_t kFieldsMax = 1000;   // BRDFs have about ten
constexpr uint32_t kDimensionsMax = 8;  // BRDFs have up to five

// The sizes in bytes of the types 1 (8-bit integers) to 12 (64-bit floats).
constexpr uint64_t kTypeSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
constexpr uint32_t kTypesMax = std::size(kTypeSizes);

std::optional<uint64_t> Little64(HeaderReader& header) {
  const auto low = header.Little32();
  const auto high = header.Little32();
  if (!low || !high) return std::nullopt;
  return uint64_t{*high} << 32 | *low;
}

std::optional<std::vector<uint64_t>> ReadShape(HeaderReader& header, uint32_t dimensions) {
  std::vector<uint64_t> shape;
  for (uint32_t i = 0; i < dimensions; ++i) {
    const auto size = Little64(header);
    if (!size) return std::nullopt;
    shape.push_back(*size);
  }
  return shape;
}

// The number of bytes of an array, or nullopt if there are more than `bytes_max`.
std::optional<uint64_t> ByteCount(const std::vector<uint64_t>& shape, uint64_t element_size,
                                  uint64_t bytes_max) {
  uint64_t bytes = element_size;
  for (const uint64_t size : shape) {
    if (size == 0) return 0;
    if (bytes > bytes_max / size) return std::nullopt;
    bytes *= size;
  }
  return bytes;
}

struct NamedField {
  std::string name;
  TensorField field;
};

Result<NamedField> ReadField(HeaderReader& header, std::string_view file) {
  const Error cut = BadInput("the header ends too early");
  const auto name_length = header.Little(2);
  if (!name_length) return cut;
  const auto name = header.Take(*name_length);
  if (!name) return cut;
  const auto dimensions = header.Little(2);
  const auto type = header.Little(1);
  const auto offset = Little64(header);
  if (!dimensions || !type || !offset) return cut;
  if (*dimensions > kDimensionsMax) {
    return BadInput(
        fmt::format("array {} has {} dimensions, more than {}", Quoted(*name), *dimensions, kDimensionsMax));
  }
  if (*type == 0 || *type > kTypesMax) {
    return BadInput(fmt::format("array {} has the unknown type {}", Quoted(*name), *type));
  }
  const auto shape = ReadShape(header, *dimensions);
  if (!shape) return cut;
  const auto bytes = ByteCount(*shape, kTypeSizes[*type - 1], file.size());
  if (!bytes || *offset > file.size() || *bytes > file.size() - *offset) {
    return BadInput(fmt::format("array {} reaches beyond the end of the file", Quoted(*name)));
  }
  TensorField field{static_cast<TensorField::Type>(*type), *shape,
                    file.substr(static_cast<size_t>(*offset), static_cast<size_t>(*bytes))};
  return NamedField{std::string(*name), std::move(field)};
}

}  // namespace

uint64_t TensorField::Count() const {
  return type == Type::kFloat32 ? bytes.size() / sizeof(float) : bytes.size();
}

Result<TensorFile> TensorFile::Parse(std::string_view bytes) {
  HeaderReader header(bytes);
  if (header.Take(kMagic.size()) != kMagic) return BadInput("not a tensor file");
  const auto major = header.Little(1), minor = header.Little(1);
  const auto count = header.Little32();
  if (!major || !minor || !count) return BadInput("the header ends too early");
  if (*major != 1 || *minor != 0) return BadInput(fmt::format("unknown version {}.{}", *major, *minor));
  if (*count > kFieldsMax) return BadInput(fmt::format("{} arrays are more than {}", *count, kFieldsMax));
  TensorFile file;
  for (uint32_t i = 0; i < *count; ++i) {
    Result<NamedField> read = ReadField(header, bytes);
    if (!read) return read.error();
    if (!file.fields_.try_emplace(read->name, std::move(read->field)).second) {
      return BadInput(fmt::format("there are two arrays {}", Quoted(read->name)));
    }
  }
  return file;
}

Result<const TensorField*> TensorFile::Find(const std::string& name, TensorField::Type type,
                                            size_t dimensions) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) return BadInput(fmt::format("there is no array \"{}\"", name));
  const TensorField& field = found->second;
  if (field.type != type || field.shape.size() != dimensions) {
    return BadInput(fmt::format("array \"{}\" does not have the type and {} dimension{} of a BRDF", name,
                                dimensions, dimensions == 1 ? "" : "s"));
  }
  return &field;
}

Result<std::vector<float>> TensorFile::Floats(const std::string& name, const TensorField& field) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<float> values(static_cast<size_t>(field.Count()));
  if (!values.empty()) std::memcpy(values.data(), field.bytes.data(), field.bytes.size());
  for (const float value : values) {
    if (!std::isfinite(value))
      return BadInput(fmt::format("array \"{}\" has a value that is not finite", name));
  }
  return values;
}

}  // namespace tessera
