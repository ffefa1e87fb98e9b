// Errors of pixels in false colours, with a legend.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// 8-bit sRGB, rows from top to bottom.
struct BytePicture {
  int width = 0, height = 0;
  std::vector<uint8_t> values;  // three for each pixel
};

// The errors of the pixels of a picture of this width.
struct ErrorMap {
  int width = 0;
  std::span<const float> errors;  // at least 0 or infinite
  float top = 1;                  // shown in the brightest colour, as are those beyond it
  std::string title;              // of the legend: letters of "FLIP MAX |A-B|", digits, ". + - E"
};

// The largest difference of the values of each pixel over the channels that both pictures have, which have
// equal windows. NaN differs from all else by infinity.
std::vector<float> LargestDifferences(const LoadedPicture& a, const LoadedPicture& b);
// The least value that at least 99 % of the errors do not exceed, so that a few large ones do not darken the
// rest; 1 if that is 0 or infinite.
float TopOf(std::vector<float> errors);

// The colours go from black through purple and orange to light yellow, ever brighter (as "magma" of
// matplotlib). Below the pixels is a bar of them with the errors that they stand for and the title.
BytePicture DrawErrors(const ErrorMap& map);

}  // namespace tessera
