#include "renderer/sampler/sampler_settings.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "renderer/description/parameter_reader.h"
#include "renderer/film/sample_range.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kKinds[] = {"independent", "stratified", "sobol", "paddedsobol", "zsobol"};
constexpr std::string_view kLaterKinds[] = {"halton", "pmj02bn"};
constexpr std::string_view kRandomizations[] = {"none", "permutedigits", "fastowen", "owen"};

Result<SamplerKind> FindKind(const Entity& entity) {
  for (size_t i = 0; i < std::size(kKinds); ++i) {
    if (entity.kind == kKinds[i]) return static_cast<SamplerKind>(i);
  }
  for (std::string_view later : kLaterKinds) {
    if (entity.kind == later)
      return ErrorAt(entity.location, "sampler \"" + entity.kind + "\" is not supported yet");
  }
  return ErrorAt(entity.location,
                 "unknown sampler \"" + entity.kind + "\"" + DidYouMean(entity.kind, kKinds));
}

// The split of `samples` into columns and rows that is nearest to a square.
void SplitIntoStrata(uint32_t samples, SamplerSettings* settings) {
  uint32_t rows = static_cast<uint32_t>(std::sqrt(static_cast<float>(samples)));
  while (rows > 1 && samples % rows != 0) --rows;
  settings->strata_y = rows;
  settings->strata_x = samples / rows;
}

void ReadStrata(ParameterReader& reader, std::optional<uint32_t> samples, SamplerSettings* settings) {
  settings->jitter = reader.Bool("jitter", true);
  const int x = reader.Integer("xsamples", 4);
  const int y = reader.Integer("ysamples", 4);
  if (x < 1 || y < 1 || static_cast<int64_t>(x) * y > kSamplesPerPixelMax) {
    return reader.FailAt(x < 1 ? "xsamples" : "ysamples",
                         "strata must be at least 1 and their product at most 2^20");
  }
  settings->strata_x = static_cast<uint32_t>(x);
  settings->strata_y = static_cast<uint32_t>(y);
  if (samples) SplitIntoStrata(*samples, settings);
  settings->samples_per_pixel = settings->strata_x * settings->strata_y;
}

void ReadSampleCount(ParameterReader& reader, std::optional<uint32_t> samples, SamplerSettings* settings) {
  const int asked = reader.Integer("pixelsamples", settings->kind == SamplerKind::kIndependent ? 4 : 16);
  if (!samples && (asked < 1 || static_cast<uint32_t>(asked) > kSamplesPerPixelMax)) {
    return reader.FailAt("pixelsamples", "pixelsamples must lie between 1 and 2^20");
  }
  settings->samples_per_pixel = samples ? *samples : static_cast<uint32_t>(asked);
}

// A power of two, as the sequence needs: rounded down like pbrt's.
void PrepareZSobol(const Entity& entity, int width, int height, SamplerSettings* settings,
                   Diagnostics& diagnostics) {
  settings->log2_samples = std::bit_width(settings->samples_per_pixel) - 1;
  const uint32_t rounded = 1u << settings->log2_samples;
  if (rounded != settings->samples_per_pixel) {
    diagnostics.Warn(
        entity.location,
        fmt::format("sampler \"zsobol\" needs a power of two: {} samples per pixel instead of {}", rounded,
                    settings->samples_per_pixel));
    settings->samples_per_pixel = rounded;
  }
  const uint32_t side = std::bit_ceil(static_cast<uint32_t>(std::max(width, height)));
  settings->base4_digits = std::bit_width(side) - 1 + (settings->log2_samples + 1) / 2;
}

}  // namespace

Result<SamplerSettings> ReadSampler(const Entity& entity, int width, int height,
                                    std::optional<uint32_t> samples, std::optional<uint64_t> seed,
                                    uint64_t default_seed, Diagnostics& diagnostics) {
  const Result<SamplerKind> kind = FindKind(entity);
  if (!kind) return kind.error();
  ParameterReader reader(entity);
  SamplerSettings settings;
  settings.kind = *kind;
  settings.seed =
      static_cast<uint64_t>(static_cast<int64_t>(reader.Integer("seed", static_cast<int>(default_seed))));
  if (seed) settings.seed = *seed;
  if (settings.kind == SamplerKind::kStratified) {
    ReadStrata(reader, samples, &settings);
  } else {
    ReadSampleCount(reader, samples, &settings);
    if (settings.kind != SamplerKind::kIndependent) {
      const std::string name = reader.Choice("randomization", "fastowen", kRandomizations);
      for (size_t i = 0; i < std::size(kRandomizations); ++i) {
        if (name == kRandomizations[i]) settings.randomization = static_cast<Randomization>(i);
      }
    }
  }
  if (Result<void> done = reader.Finish(); !done) return done.error();
  if (settings.kind == SamplerKind::kZSobol) PrepareZSobol(entity, width, height, &settings, diagnostics);
  return settings;
}

}  // namespace tessera
