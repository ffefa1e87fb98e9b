#include "tests/build_paths.h"

namespace tessera {

const std::string& SourceDir() {
  static const std::string dir = TESSERA_SOURCE_DIR;
  return dir;
}

const std::string& BinaryDir() {
  static const std::string dir = TESSERA_BINARY_DIR;
  return dir;
}

}  // namespace tessera
