// The release, named here alone: CMakeLists.txt reads it, all programs and the headers of pictures show it,
// and the programs of a farm must agree on it, because pictures are exact per release.
#pragma once

namespace tessera {

constexpr const char* kRelease = "0.2.0";

}  // namespace tessera
