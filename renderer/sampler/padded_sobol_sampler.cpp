#include "renderer/sampler/padded_sobol_sampler.h"

namespace tessera {

PaddedSobolSampler PaddedSobolSampler::Read(SamplerDirective& directive) {
  directive.ReadSampleCount(16);
  return {directive.seed, directive.ReadRandomization()};
}

}  // namespace tessera
