// FLIP: how much two pictures differ to an observer who alternates between them on one screen.
//
//   LDR-FLIP: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom and Fairchild, "FLIP: A Difference
//             Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020
//   HDR-FLIP: Andersson, Nilsson, Shirley and Akenine-Moeller, "Visualizing Errors in Rendered High Dynamic
//             Range Images", Eurographics Short Papers 2021
//
// The observer sits 0.7 m before a screen 0.7 m wide with 3840 pixels across: 67 pixels per degree. The
// other constants are those of the papers and have names in flip.cpp and exposures.h. HDR-FLIP takes the
// largest LDR-FLIP over a range of exposures that the reference determines, tone-mapped by ACES in the fit of
// Narkowicz (2015).
#pragma once

#include <stop_token>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// 2^exposure is what radiance is multiplied by.
struct ExposureRange {
  double start = 0, stop = 0;
  int count = 1;  // evenly spaced, both ends included
};

struct FlipErrors {
  int width = 0, height = 0;  // the data window
  std::vector<float> errors;  // for each pixel, from 0 (equal) to 1; rows from top to bottom
  double mean = 0;
  ExposureRange exposures;  // of HDR-FLIP
};

// Whether the picture has the channels R, G and B, which FLIP looks at.
bool HasColors(const LoadedPicture& picture);

// Both need pictures with equal windows that have colours. Values below zero and NaN count as zero. The
// result does not depend on the number of threads. Fails if memory runs out or a stop is requested.
//
// Values are linear and count as 1 from there on.
Result<FlipErrors> LdrFlip(const LoadedPicture& test, const LoadedPicture& reference, int threads,
                           const std::stop_token& stop);
Result<FlipErrors> HdrFlip(const LoadedPicture& test, const LoadedPicture& reference, int threads,
                           const std::stop_token& stop);

}  // namespace tessera
