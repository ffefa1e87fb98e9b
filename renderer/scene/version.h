// The release that this is.
#pragma once

#include <string_view>

namespace tessera {

// Of all programs, of the headers of pictures, and what coordinator and worker must agree on.
constexpr std::string_view kVersion = "0.1.0";

}  // namespace tessera
