// What the Sampler directive asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/sampler/sobol.h"
#include "renderer/util/result.h"

namespace tessera {

enum class SamplerKind { kIndependent, kStratified, kSobol, kPaddedSobol, kZSobol };

struct SamplerSettings {
  SamplerKind kind = SamplerKind::kZSobol;
  Randomization randomization = Randomization::kFastOwen;
  uint64_t seed = 0;
  uint32_t samples_per_pixel = 16;
  uint32_t strata_x = 4, strata_y = 4;  // stratified: their product is samples_per_pixel
  bool jitter = true;
  int log2_samples = 4;  // zsobol: samples_per_pixel is this power of two
  int base4_digits = 0;  // zsobol: of the Morton place, sample index included

  // Whether the first samples of a pixel are others when there are more of them.
  bool DependsOnCount() const { return kind == SamplerKind::kStratified || kind == SamplerKind::kZSobol; }
};

// Reads a Sampler directive. `samples` and `seed` override the scene's. `width` and `height` are those of the
// whole picture. What is done otherwise than asked is added to `diagnostics`.
Result<SamplerSettings> ReadSampler(const Entity& entity, int width, int height,
                                    std::optional<uint32_t> samples, std::optional<uint64_t> seed,
                                    uint64_t default_seed, Diagnostics& diagnostics);

}  // namespace tessera
