#include "renderer/sampler/independent_sampler.h"

namespace tessera {

IndependentSampler IndependentSampler::Read(SamplerDirective& directive) {
  directive.ReadSampleCount(4);
  return IndependentSampler(directive.seed);
}

}  // namespace tessera
