#include "renderer/sampler/sampler.h"

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

float Sampler::Stratified1D() {
  const uint64_t seed = DimensionSeed(dimension_++);
  const uint32_t count = settings_.strata_x * settings_.strata_y;
  const uint32_t stratum = PermutationElement(index_ % count, count, static_cast<uint32_t>(seed));
  const float offset =
      settings_.jitter ? UniformFloat(static_cast<uint32_t>(Hash(seed, index_) >> 32)) : 0.5f;
  return std::min((stratum + offset) / count, kOneMinusEpsilon);
}

Point2 Sampler::Stratified2D() {
  const uint64_t seed = DimensionSeed(dimension_);
  dimension_ += 2;
  const uint32_t count = settings_.strata_x * settings_.strata_y;
  const uint32_t stratum = PermutationElement(index_ % count, count, static_cast<uint32_t>(seed));
  const uint64_t bits = Hash(seed, index_);
  const float dx = settings_.jitter ? UniformFloat(static_cast<uint32_t>(bits >> 32)) : 0.5f;
  const float dy = settings_.jitter ? UniformFloat(static_cast<uint32_t>(bits)) : 0.5f;
  const uint32_t column = stratum % settings_.strata_x;
  const uint32_t row = stratum / settings_.strata_x;
  return {std::min((column + dx) / settings_.strata_x, kOneMinusEpsilon),
          std::min((row + dy) / settings_.strata_y, kOneMinusEpsilon)};
}

void Sampler::StartZSobol() {
  morton_index_ = ((SpreadBits(static_cast<uint32_t>(x_)) | SpreadBits(static_cast<uint32_t>(y_)) << 1)
                   << settings_.log2_samples) |
                  index_;
}

// The Morton place with its base-4 digits permuted, each by a hash of the digits above it and the dimension;
// with an odd number of bits the last is a base-2 digit.
uint64_t Sampler::ZSobolIndex() const {
  const bool odd = (settings_.log2_samples & 1) != 0;
  const uint64_t salt = Hash(settings_.seed, dimension_);
  uint64_t index = 0;
  for (int digit = settings_.base4_digits - 1; digit >= (odd ? 1 : 0); --digit) {
    const int shift = 2 * digit - (odd ? 1 : 0);
    const uint64_t above = morton_index_ >> (shift + 2);
    const int order = static_cast<int>(((MixBits(above ^ salt) >> 32) * 24) >> 32);
    const uint64_t value = (kDigitOrders.order[order] >> (2 * ((morton_index_ >> shift) & 3))) & 3;
    index |= value << shift;
  }
  if (odd) index |= (morton_index_ & 1) ^ (MixBits((morton_index_ >> 1) ^ salt) >> 63);
  return index;
}

float Sampler::ZSobol1D() {
  const uint64_t index = ZSobolIndex();
  const uint64_t seed = Hash(settings_.seed, dimension_++, 1);
  return Fraction(SobolBitsWide(matrices_, index, 0), static_cast<uint32_t>(seed));
}

Point2 Sampler::ZSobol2D() {
  const uint64_t index = ZSobolIndex();
  const uint64_t seed = Hash(settings_.seed, dimension_, 2);
  dimension_ += 2;
  return {Fraction(SobolBitsWide(matrices_, index, 0), static_cast<uint32_t>(seed)),
          Fraction(SobolBitsWide(matrices_, index, 1), static_cast<uint32_t>(seed >> 32))};
}

}  // namespace tessera
