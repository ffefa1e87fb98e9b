// Checks of a file's structure before a library decodes it: that it is complete, which libraries do not
// always check, and that it is not damaged in ways about which they print to stderr instead of returning an
// error.

#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

// Whether the chunks follow each other up to the end mark, with correct checksums.
Result<void> CheckPng(const std::string& bytes, const std::string& name);

// Whether the pixels are not compressed: the library reads and writes beyond its memory if the compression
// does not belong to the palette. pbrt reads no compressed ones either.
Result<void> CheckBmp(const std::string& bytes, const std::string& name);

// Whether the segments lead to the pixels, and the pixels to the end mark.
Result<void> CheckJpeg(const std::string& bytes, const std::string& name);

}  // namespace tessera
