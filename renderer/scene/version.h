// The version of this release.
#pragma once

#include <string_view>

namespace tessera {

// Shown by all programs and in the headers of pictures; coordinator and worker must agree on it.
constexpr std::string_view kVersion = "0.1.0";

// Attributes in the header of a picture: the release that its frame was submitted with.
constexpr const char* kVersionAttribute = "tessera:version";
constexpr const char* kSoftwareAttribute = "software";

}  // namespace tessera
