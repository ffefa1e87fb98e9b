#include "renderer/sampler/zsobol_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

// Spreads the bits of v to the even places.
uint64_t SpreadBits(uint32_t v) {
  uint64_t x = v;
  x = (x | (x << 16)) & 0x0000ffff0000ffffu;
  x = (x | (x << 8)) & 0x00ff00ff00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0f0f0f0f0fu;
  x = (x | (x << 2)) & 0x3333333333333333u;
  return (x | (x << 1)) & 0x5555555555555555u;
}

// The 24 orders of four things, two bits each.
struct DigitOrders {
  uint8_t order[24];
  DigitOrders() {
    int n = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        for (int c = 0; c < 4; ++c) {
          if (a == b || a == c || b == c) continue;
          order[n++] = static_cast<uint8_t>(a | b << 2 | c << 4 | (6 - a - b - c) << 6);
        }
      }
    }
  }
};
const DigitOrders kDigitOrders;

}  // namespace

// The sequence needs a power of two samples: their number is rounded down, as pbrt does.
ZSobolSampler ZSobolSampler::Read(SamplerDirective& directive) {
  const uint32_t asked = directive.ReadSampleCount(16);
  const Randomization randomization = directive.ReadRandomization();
  const int log2_samples = std::bit_width(asked) - 1;
  const uint32_t rounded = 1u << log2_samples;
  if (rounded != asked) {
    directive.diagnostics.Warn(
        directive.reader.entity().location,
        fmt::format("sampler \"zsobol\" needs a power of two: {} samples per pixel instead of {}", rounded,
                    asked));
    directive.samples_per_pixel = rounded;
  }
  return {directive.seed, randomization, log2_samples, directive.width, directive.height};
}

ZSobolSampler::ZSobolSampler(uint64_t seed, Randomization randomization, int log2_samples, int width,
                             int height)
    : seed_(seed), matrices_(&Matrices()), randomization_(randomization), log2_samples_(log2_samples) {
  const uint32_t side = std::bit_ceil(static_cast<uint32_t>(std::max(width, height)));
  base4_digits_ = std::bit_width(side) - 1 + (log2_samples + 1) / 2;
  for (int i = 0; i < kKept; ++i) seeds_[static_cast<size_t>(i)] = MakeSeeds(i);
}

void ZSobolSampler::StartSample(int x, int y, uint32_t index) {
  const uint64_t pixel = SpreadBits(static_cast<uint32_t>(x)) | SpreadBits(static_cast<uint32_t>(y)) << 1;
  if (morton_place_ >> log2_samples_ != pixel) is_kept_ = 0;
  morton_place_ = pixel << log2_samples_ | index;
  dimension_ = 0;
}

// Each digit is permuted by a hash of the digits above it and the dimension.
uint64_t ZSobolSampler::Permuted(int begin, int end, uint64_t seed) const {
  const int odd = log2_samples_ & 1;
  uint64_t permuted = 0;
  for (int digit = begin - 1; digit >= end; --digit) {
    const int shift = 2 * digit - odd;
    const uint64_t above = morton_place_ >> (shift + 2);
    const int order = static_cast<int>(((MixBits(above ^ seed) >> 32) * 24) >> 32);
    const uint64_t value = (kDigitOrders.order[order] >> (2 * ((morton_place_ >> shift) & 3))) & 3;
    permuted |= value << shift;
  }
  return permuted;
}

ZSobolSampler::Seeds ZSobolSampler::MakeSeeds(int dimension) const {
  return {Hash(seed_, dimension), Hash(seed_, dimension, 1), Hash(seed_, dimension, 2)};
}

ZSobolSampler::Points ZSobolSampler::PointsOfPixel(int dimension, uint64_t seed) {
  const int of_sample = (log2_samples_ + 1) / 2;  // the digits below depend on the index of the sample
  if (dimension >= kKept) return PointsOf(Permuted(base4_digits_, of_sample, seed));
  const uint64_t bit = uint64_t{1} << dimension;
  Points& kept = kept_[static_cast<size_t>(dimension)];
  if ((is_kept_ & bit) == 0) {
    kept = PointsOf(Permuted(base4_digits_, of_sample, seed));
    is_kept_ |= bit;
  }
  return kept;
}

// Those of the Morton place with its base-4 digits permuted; with an odd number of bits the last is a base-2
// digit. Points are exclusive-ors over the bits of the index, so that its parts can be joined afterwards.
ZSobolSampler::Points ZSobolSampler::PointsAt(int dimension, uint64_t seed) {
  const int odd = log2_samples_ & 1;
  uint64_t index = Permuted((log2_samples_ + 1) / 2, odd, seed);
  if (odd != 0) index |= (morton_place_ & 1) ^ (MixBits((morton_place_ >> 1) ^ seed) >> 63);
  const Points pixel = PointsOfPixel(dimension, seed);
  const Points sample = PointsOf(index);
  return {pixel.x ^ sample.x, pixel.y ^ sample.y};
}

float ZSobolSampler::Get1D() {
  const Seeds seeds = SeedsOf(dimension_);
  const Points points = PointsAt(dimension_++, seeds.digits);
  return RandomizedFraction(randomization_, points.x, static_cast<uint32_t>(seeds.single));
}

Point2 ZSobolSampler::Get2D() {
  const Seeds seeds = SeedsOf(dimension_);
  const Points points = PointsAt(dimension_, seeds.digits);
  dimension_ += 2;
  return {RandomizedFraction(randomization_, points.x, static_cast<uint32_t>(seeds.pair)),
          RandomizedFraction(randomization_, points.y, static_cast<uint32_t>(seeds.pair >> 32))};
}

}  // namespace tessera
