// The version of this release.
#pragma once

#include <string_view>

namespace tessera {

// Shown by all programs and in the headers of pictures; coordinator and worker must agree on it.
constexpr std::string_view kVersion = "0.1.0";

}  // namespace tessera
