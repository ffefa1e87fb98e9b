// How much two pictures differ, value by value.
#pragma once

#include <string>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// The difference over the channels that both pictures have. relMSE is the mean of (a - b)^2 / (b^2 + 0.01),
// PSNR is for a peak of 1. Values that are not finite and not equal differ by infinity.
struct PictureDifference {
  double mse = 0, relmse = 0, psnr_db = 0, maxabs = 0;
  bool identical = false;  // same windows, same channels, same bits
};
// An error if the windows differ or there is no channel in common.
Result<PictureDifference> Compare(const LoadedPicture& a, const LoadedPicture& b);

}  // namespace tessera
