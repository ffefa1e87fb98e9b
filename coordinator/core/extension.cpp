#include "coordinator/core/extension.h"

#include <bit>

namespace tessera {

uint64_t SamplesOf(const FrameSpec& spec) {
  return static_cast<uint64_t>(spec.crop.area()) * spec.samples_per_pixel;
}

uint64_t SamplesOf(const JobSpec& spec) {
  uint64_t samples = 0;
  for (const FrameRequest& frame : spec.frames) samples += SamplesOf(frame.spec);
  return samples;
}

// One node of each tile for each power of two in the number of samples.
uint64_t SumsBytes(const FrameSpec& spec) {
  const auto terms = static_cast<uint64_t>(std::popcount(spec.samples_per_pixel));
  return static_cast<uint64_t>(spec.crop.area()) * spec.Layout().shape().floats_max() * sizeof(float) * terms;
}

bool IsExtendable(const FrameRequest& frame) {
  return frame.extendable && !frame.spec.IsAdaptive();
}

std::shared_ptr<const JobSpec> ExtendedSpec(const JobSpec& spec, uint32_t samples_per_pixel) {
  auto extended = std::make_shared<JobSpec>(spec);
  for (FrameRequest& frame : extended->frames) {
    if (frame.spec.samples_per_pixel >= samples_per_pixel) continue;
    frame.spec.samples_per_pixel = samples_per_pixel;
    const auto attribute = frame.spec.attributes.find(kSamplesAttribute);
    if (attribute != frame.spec.attributes.end()) attribute->second = std::to_string(samples_per_pixel);
  }
  return extended;
}

}  // namespace tessera
