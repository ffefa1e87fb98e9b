#include "renderer/sampler/sampler_settings.h"

namespace tessera {
namespace {

using SamplerReader = Sampler (*)(SamplerDirective& directive);

template <SamplerKind T>
Sampler Read(SamplerDirective& directive) {
  return T::Read(directive);
}

constexpr Kind<SamplerReader> kSamplers[] = {
    {"independent", Support::kSupported, Read<IndependentSampler>},
    {"stratified", Support::kSupported, Read<StratifiedSampler>},
    {"sobol", Support::kSupported, Read<SobolSampler>},
    {"paddedsobol", Support::kSupported, Read<PaddedSobolSampler>},
    {"zsobol", Support::kSupported, Read<ZSobolSampler>},
    {"halton", Support::kSupported, Read<HaltonSampler>},
    {"pmj02bn", Support::kSupported, Read<Pmj02bnSampler>},
};
constexpr KindTable<SamplerReader> kSamplerTable("sampler", kSamplers);

}  // namespace

Result<SamplerSettings> ReadSampler(const Entity& entity, int width, int height,
                                    const SamplerOverrides& overrides, uint64_t default_seed,
                                    Diagnostics& diagnostics) {
  const Kind<SamplerReader>* kind = kSamplerTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kSamplerTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  SamplerSettings settings;
  settings.seed =
      static_cast<uint64_t>(static_cast<int64_t>(reader.Integer("seed", static_cast<int>(default_seed))));
  if (overrides.seed) settings.seed = *overrides.seed;
  SamplerDirective directive{reader, width, height, settings.seed, overrides.samples_per_pixel, diagnostics};
  settings.sampler = kind->reader(directive);
  settings.samples_per_pixel = directive.samples_per_pixel;
  if (Result<void> done = reader.Finish(); !done) return done.error();
  return settings;
}

KindList SamplerKinds() {
  return kSamplerTable.List();
}

}  // namespace tessera
