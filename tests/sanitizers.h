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

// How many times slower a build with a sanitizer is, roughly. Tests wait that much longer, and long renders
// of tests have that many samples less.
constexpr int kSlowdown = kHasSanitizer ? 8 : 1;

// The bound in bytes for a program of the same build that may take `bytes` without a sanitizer, which shadows
// memory and keeps what was freed last, up to 256 MB.
constexpr size_t MemoryBound(size_t bytes) {
  return kHasSanitizer ? 4 * bytes + (size_t{256} << 20) : bytes;
}

}  // namespace tessera
