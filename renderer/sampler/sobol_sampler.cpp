#include "renderer/sampler/sobol_sampler.h"

namespace tessera {

SobolSampler SobolSampler::Read(SamplerDirective& directive) {
  directive.ReadSampleCount(16);
  return {directive.seed, directive.ReadRandomization()};
}

}  // namespace tessera
