#include "renderer/texture/image_color_space.h"

#include <fmt/format.h>

namespace tessera {

const ColorSpace& ColorSpaceOf(const std::optional<Chromaticities>& chromaticities,
                               const ParameterReader& reader, Diagnostics& diagnostics) {
  if (!chromaticities) return ColorSpace::Srgb();
  const auto& [red, green, blue, white] = *chromaticities;
  if (const ColorSpace* space = ColorSpace::Matching(red, green, blue, white)) return *space;
  diagnostics.Warn(
      reader.LocationOf("filename"),
      fmt::format(
          "the image has the chromaticities red {} {}, green {} {}, blue {} {}, white {} {}, which are "
          "those of none of the supported colour spaces; it is read as sRGB",
          red.x, red.y, green.x, green.y, blue.x, blue.y, white.x, white.y));
  return ColorSpace::Srgb();
}

}  // namespace tessera
