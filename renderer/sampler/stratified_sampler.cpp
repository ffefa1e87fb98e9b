#include "renderer/sampler/stratified_sampler.h"

#include <algorithm>
#include <cmath>

#include "renderer/film/sample_range.h"
#include "renderer/sampler/sobol.h"

namespace tessera {
namespace {

struct Strata {
  uint32_t columns = 1, rows = 1;
};

// The split of `samples` into columns and rows that is nearest to a square.
Strata SplitIntoStrata(uint32_t samples) {
  uint32_t rows = static_cast<uint32_t>(std::sqrt(static_cast<float>(samples)));
  while (rows > 1 && samples % rows != 0) --rows;
  return {samples / rows, rows};
}

}  // namespace

StratifiedSampler StratifiedSampler::Read(SamplerDirective& directive) {
  ParameterReader& reader = directive.reader;
  const bool jitter = reader.Bool("jitter", true);
  const int x = reader.Integer("xsamples", 4);
  const int y = reader.Integer("ysamples", 4);
  Strata strata;
  if (x < 1 || y < 1 || static_cast<int64_t>(x) * y > kSamplesPerPixelMax) {
    reader.FailAt(x < 1 ? "xsamples" : "ysamples",
                  "strata must be at least 1 and their product at most 2^20");
  } else if (directive.samples_override) {
    strata = SplitIntoStrata(*directive.samples_override);
  } else {
    strata = {static_cast<uint32_t>(x), static_cast<uint32_t>(y)};
  }
  directive.samples_per_pixel = strata.columns * strata.rows;
  return {directive.seed, strata.columns, strata.rows, jitter};
}

float StratifiedSampler::Get1D() {
  const uint64_t seed = seed_.OfDimension(dimension_++);
  const uint32_t count = columns_ * rows_;
  const uint32_t stratum = PermutationElement(index_ % count, count, static_cast<uint32_t>(seed));
  const float offset = jitter_ ? UniformFloat(static_cast<uint32_t>(Hash(seed, index_) >> 32)) : 0.5f;
  return std::min((stratum + offset) / count, kOneMinusEpsilon);
}

Point2 StratifiedSampler::Get2D() {
  const uint64_t seed = seed_.OfDimension(dimension_);
  dimension_ += 2;
  const uint32_t count = columns_ * rows_;
  const uint32_t stratum = PermutationElement(index_ % count, count, static_cast<uint32_t>(seed));
  const uint64_t bits = Hash(seed, index_);
  const float dx = jitter_ ? UniformFloat(static_cast<uint32_t>(bits >> 32)) : 0.5f;
  const float dy = jitter_ ? UniformFloat(static_cast<uint32_t>(bits)) : 0.5f;
  const uint32_t column = stratum % columns_;
  const uint32_t row = stratum / columns_;
  return {std::min((column + dx) / columns_, kOneMinusEpsilon),
          std::min((row + dy) / rows_, kOneMinusEpsilon)};
}

}  // namespace tessera
