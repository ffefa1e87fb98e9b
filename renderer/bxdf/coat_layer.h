// The layer between a coat and its base.
#pragma once

#include <cmath>
#include <limits>

#include "renderer/color/sampled_spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

struct CoatLayer {
  SampledSpectrum albedo;   // single-scattering
  float thickness = 0.01f;  // in units of the mean free path, positive
  float g = 0;              // of the Henyey-Greenstein phase function
  int depth_max = 10;       // events of one walk
  int sample_count = 1;     // walks per evaluation
};

// What is left of light that crosses `distance` of the layer's height along w.
inline float LayerTransmittance(float distance, Vec3 w) {
  if (std::abs(distance) <= std::numeric_limits<float>::min()) return 1;
  return std::exp(-std::abs(distance / w.z));
}

}  // namespace tessera
