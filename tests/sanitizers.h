// What tests allow for when they are built with a sanitizer.
#pragma once

#include <cstddef>

namespace tessera {

// Whether there is one that maps terabytes of address space, so that a test cannot limit it.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasSanitizer = true;
#else
constexpr bool kHasSanitizer = false;
#endif

// The bound in bytes for a program of the same build that may take `bytes` without a sanitizer, which shadows
// memory and keeps what is freed for a while.
constexpr size_t MemoryBound(size_t bytes) {
  return kHasSanitizer ? 4 * bytes : bytes;
}

}  // namespace tessera
