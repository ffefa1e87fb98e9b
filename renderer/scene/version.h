// How the header of a picture names the release.
#pragma once

namespace tessera {

// Attributes in the header of a picture: the release that its frame was submitted with.
constexpr const char* kVersionAttribute = "tessera:version";
constexpr const char* kSoftwareAttribute = "software";

}  // namespace tessera
