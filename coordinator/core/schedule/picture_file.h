// What is known of a file that was written for a finished frame.
#pragma once

#include <cstdint>

#include "renderer/util/digest.h"

namespace tessera {

struct PictureFile {
  Digest digest;       // of its bytes
  uint64_t bytes = 0;  // 0: written by a release that did not record its size

  bool operator==(const PictureFile&) const = default;
};

}  // namespace tessera
