// Which build of the program this is.
#pragma once

#include <string>

namespace tessera {

// The linker's build id of the running executable, raw bytes: a hash of all that was linked into it. Empty if
// it was linked without one.
std::string BuildId();

// The build ids of the executable and of all libraries that are loaded now, in their order. Empty if one of
// them was linked without one.
std::string LoadedBuildIds();

}  // namespace tessera
