// Pictures whose rows are not stored from top to bottom, or whose pixels are not stored from left to right.
#pragma once

#include <optional>
#include <string_view>

#include "renderer/image/image.h"

namespace tessera {

// How the stored pixels become upright: first rows and columns are exchanged, then the picture is mirrored.
struct Orientation {
  bool is_transposed = false;
  bool flips_x = false;  // left and right
  bool flips_y = false;  // top and bottom
  bool operator==(const Orientation&) const = default;
};

// Of the value of the Exif and TIFF tag "Orientation". Returns nullopt for values that the tag does not have.
std::optional<Orientation> OrientationOfTag(int value);

// Of a Radiance file: its resolution line, "-Y 480 +X 640", names the axis and direction of the rows first
// (Ward 1991). Returns nullopt if there is no such line.
std::optional<Orientation> OrientationOfRadiance(std::string_view bytes);

void MakeUpright(Image& image, Orientation orientation);

}  // namespace tessera
