// A Sampler directive while a kind of sampler reads its parameters.
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/description/diagnostics.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/sampler/sobol.h"

namespace tessera {

struct SamplerDirective {
  ParameterReader& reader;
  int width, height;  // of the whole picture
  uint64_t seed;
  // The number of samples per pixel that the command line asks for instead of the scene's.
  std::optional<uint32_t> samples_override;
  Diagnostics& diagnostics;

  // The result: set by the kind.
  uint32_t samples_per_pixel = 1;

  // Reads "pixelsamples" and sets samples_per_pixel, which it returns.
  uint32_t ReadSampleCount(int default_count);
  Randomization ReadRandomization(Randomization default_value = Randomization::kFastOwen);
};

}  // namespace tessera
