// The run-length encoding of early Radiance files.
#pragma once

#include <optional>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

// The file with uncompressed pixels if it has runs of the first encoding: a pixel 1 1 1 N repeats the one
// before it N times, and further such pixels count in the next higher bytes (Ward 1991). The library reads
// only the later encoding and uncompressed pixels. Returns nullopt if there are no such runs. Fails if a run
// leaves its row, the file ends early or the picture exceeds the limits of image_limits.h.
Result<std::optional<std::string>> WithoutOldRuns(const std::string& bytes, const std::string& name);

}  // namespace tessera
