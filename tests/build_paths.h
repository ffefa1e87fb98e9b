// Where the tests find the sources and the programs of the build that they belong to.
#pragma once

#include <string>

namespace tessera {

// The root of the repository.
const std::string& SourceDir();

// The folder that this build was made in; the programs are in its "bin".
const std::string& BinaryDir();

}  // namespace tessera
