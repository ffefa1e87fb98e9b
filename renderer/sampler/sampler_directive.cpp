#include "renderer/sampler/sampler_directive.h"

#include <algorithm>

#include "renderer/description/kind_table.h"
#include "renderer/film/sample_range.h"

namespace tessera {
namespace {

constexpr Kind<Randomization> kRandomizations[] = {
    {"none", Support::kSupported, Randomization::kNone},
    {"permutedigits", Support::kSupported, Randomization::kPermuteDigits},
    {"fastowen", Support::kSupported, Randomization::kFastOwen},
    {"owen", Support::kSupported, Randomization::kOwen},
};
constexpr KindTable<Randomization> kRandomizationTable("randomization", kRandomizations);

}  // namespace

uint32_t SamplerDirective::ReadSampleCount(int default_count) {
  const int asked = reader.Integer("pixelsamples", default_count);
  if (samples_override) {
    samples_per_pixel = *samples_override;
  } else if (asked < 1 || static_cast<uint32_t>(asked) > kSamplesPerPixelMax) {
    reader.FailAt("pixelsamples", "pixelsamples must lie between 1 and 2^20");
  } else {
    samples_per_pixel = static_cast<uint32_t>(asked);
  }
  return samples_per_pixel;
}

Randomization SamplerDirective::ReadRandomization(Randomization default_value) {
  const auto chosen = std::ranges::find(kRandomizations, default_value, &Kind<Randomization>::reader);
  const std::string name = reader.Choice("randomization", chosen->name, kRandomizationTable.Names());
  const Kind<Randomization>* kind = kRandomizationTable.Find(name);
  return kind != nullptr ? kind->reader : default_value;
}

}  // namespace tessera
