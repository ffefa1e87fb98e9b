// Files of named arrays of numbers, as the measured BRDFs of RGL have (endings .bsdf): a header with the
// type, shape and place of each array, then their values, least significant byte first.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// One array. Its bytes are within the file.
struct TensorField {
  enum class Type : uint8_t { kUint8 = 1, kFloat32 = 10 };  // the types that BRDFs use; there are others

  Type type = Type::kUint8;
  std::vector<uint64_t> shape;  // the last dimension changes fastest
  std::string_view bytes;       // of the file; as many as the shape says

  uint64_t Count() const;
};

class TensorFile {
 public:
  // `bytes` must outlive this. Everything that the header announces is compared with the size of the file.
  static Result<TensorFile> Parse(std::string_view bytes);

  // The array of this name and type with this number of dimensions.
  Result<const TensorField*> Find(const std::string& name, TensorField::Type type, size_t dimensions) const;
  // The values of an array of floats. An error that names it if one is not finite.
  static Result<std::vector<float>> Floats(const std::string& name, const TensorField& field);

 private:
  std::map<std::string, TensorField> fields_;
};

}  // namespace tessera
