// From the chromaticities that a picture names to a colour space.
#pragma once

#include <optional>

#include "renderer/color/color_space.h"
#include "renderer/description/diagnostics.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/image/image.h"

namespace tessera {

// The colour space of the picture that parameter `filename` names: sRGB if its file names none. If it names
// one that is not among the four supported, its values count as sRGB, as in pbrt, and a warning names them.
const ColorSpace& ColorSpaceOf(const std::optional<Chromaticities>& chromaticities,
                               const ParameterReader& reader, Diagnostics& diagnostics);

}  // namespace tessera
