// A look at the outside of a file before a library reads the inside: that it is whole, which libraries do not
// always ask, and that it is not damaged in ways that make them print to stderr what only the caller should
// say.
#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

// Whether the chunks follow each other to the end mark, with right checksums.
Result<void> CheckPng(const std::string& bytes, const std::string& name);

// Whether the segments lead to the pixels, and these to the end mark.
Result<void> CheckJpeg(const std::string& bytes, const std::string& name);

}  // namespace tessera
