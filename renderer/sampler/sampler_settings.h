// What the Sampler directive asks for.
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"
#include "renderer/sampler/sampler.h"
#include "renderer/util/result.h"

namespace tessera {

struct SamplerSettings {
  // Not started: each render thread uses a copy.
  Sampler sampler;
  uint64_t seed = 0;
  uint32_t samples_per_pixel = 1;
};

// What the command line may ask for instead of the scene.
struct SamplerOverrides {
  std::optional<uint32_t> samples_per_pixel;
  std::optional<uint64_t> seed;
};

// Reads a Sampler directive for a picture of width x height pixels. `default_seed` is the seed of directives
// that have none. Warns if the number of samples is not the one that was asked for.
Result<SamplerSettings> ReadSampler(const Entity& entity, int width, int height,
                                    const SamplerOverrides& overrides, uint64_t default_seed,
                                    Diagnostics& diagnostics);

KindList SamplerKinds();

}  // namespace tessera
