// What to use in place of the flags of pbrt's command line that have another name here, or none.
#pragma once

#include <optional>
#include <string_view>

namespace tessera {

// The end of a sentence that names `flag` ("--outfile"): "is -o FILE here". Returns nullopt for a flag that
// is not pbrt's.
std::optional<std::string_view> PbrtFlagHint(std::string_view flag);

}  // namespace tessera
