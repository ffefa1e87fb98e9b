#include "renderer/sampler/pmj02bn_sampler.h"

namespace tessera {

Pmj02bnSampler Pmj02bnSampler::Read(SamplerDirective& directive) {
  directive.ReadSampleCount(16);
  return Pmj02bnSampler(directive.seed);
}

void Pmj02bnSampler::StartSample(int x, int y, uint32_t index) {
  x_ = x;
  y_ = y;
  index_ = index;
  dimension_ = 0;
  tile_ = Hash(seed_, x / kBlueNoiseSide, y / kBlueNoiseSide);
}

}  // namespace tessera
