// Random numbers for one sample of one pixel. Every value is a function of (settings, pixel, sample index,
// dimension) alone, so that any sample can be drawn anywhere, in any order.
//
//   independent   hashes; no structure between samples
//   stratified    jittered strata over the samples of a pixel; the sequence depends on the sample count
//   sobol         Sobol' points in as many dimensions as a path asks for, scrambled anew for every pixel
//   paddedsobol   two-dimensional Sobol' points, shuffled and scrambled anew for every pair of dimensions
//   zsobol        one two-dimensional Sobol' sequence along a Morton curve over all pixels (Ahmed and Wonka
//   2020): the
//                 errors of neighbouring pixels differ, which looks less noisy; depends on the sample count
#pragma once

#include <cstdint>

#include "renderer/math/random_stream.h"
#include "renderer/math/vec.h"
#include "renderer/sampler/sampler_settings.h"
#include "renderer/sampler/sobol.h"

namespace tessera {

// One per render thread; a small value.
class Sampler {
 public:
  explicit Sampler(const SamplerSettings& settings) : settings_(settings), matrices_(Matrices()) {}

  // Begins sample `index` of pixel (x, y) at dimension 0.
  void StartSample(int x, int y, uint32_t index) {
    dimension_ = 0;
    index_ = index;
    if (x != x_ || y != y_) {
      x_ = x;
      y_ = y;
      pixel_seed_ = Hash(settings_.seed, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
    }
    switch (settings_.kind) {
      case SamplerKind::kIndependent: independent_ = RandomStream(Hash(pixel_seed_, index)); break;
      case SamplerKind::kZSobol: StartZSobol(); break;
      default: break;
    }
  }

  // The next dimension, in [0, 1).
  float Get1D() {
    switch (settings_.kind) {
      case SamplerKind::kIndependent: return independent_.Next();
      case SamplerKind::kSobol: return Sobol(dimension_++);
      case SamplerKind::kPaddedSobol: {
        const uint64_t seed = DimensionSeed(dimension_++);
        return Fraction(SobolBits(matrices_, Shuffled(seed), 0), static_cast<uint32_t>(seed));
      }
      case SamplerKind::kStratified: return Stratified1D();
      case SamplerKind::kZSobol: return ZSobol1D();
    }
    return 0;
  }

  // The next two dimensions together, in [0, 1)^2.
  Point2 Get2D() {
    switch (settings_.kind) {
      case SamplerKind::kIndependent: return independent_.Next2();
      case SamplerKind::kSobol: {
        const float a = Sobol(dimension_++);
        const float b = Sobol(dimension_++);
        return {a, b};
      }
      case SamplerKind::kPaddedSobol: {
        const uint64_t seed = DimensionSeed(dimension_);
        dimension_ += 2;
        const uint32_t index = Shuffled(seed);
        return {Fraction(SobolBits(matrices_, index, 0), static_cast<uint32_t>(seed)),
                Fraction(SobolBits(matrices_, index, 1), static_cast<uint32_t>(MixBits(seed)))};
      }
      case SamplerKind::kStratified: return Stratified2D();
      case SamplerKind::kZSobol: return ZSobol2D();
    }
    return {};
  }

 private:
  uint64_t DimensionSeed(int dimension) const {
    return MixBits(pixel_seed_ ^ (static_cast<uint64_t>(dimension) + 1) * 0x9e3779b97f4a7c15u);
  }
  float Fraction(uint32_t bits, uint32_t seed) const {
    return UniformFloat(Randomize(settings_.randomization, bits, seed));
  }
  // A nested shuffle of the sample index: aligned blocks of a power of two go to aligned blocks, so that
  // every prefix is stratified as well as before.
  uint32_t Shuffled(uint64_t seed) const {
    return FastOwenScramble(index_, static_cast<uint32_t>(seed >> 32));
  }
  float Sobol(int dimension) const;
  float Stratified1D();
  Point2 Stratified2D();
  void StartZSobol();
  uint64_t ZSobolIndex() const;
  float ZSobol1D();
  Point2 ZSobol2D();

  SamplerSettings settings_;
  const SobolMatrices& matrices_;
  int x_ = -1, y_ = -1;
  uint32_t index_ = 0;
  int dimension_ = 0;
  uint64_t pixel_seed_ = 0;
  RandomStream independent_;   // of kIndependent
  uint64_t morton_index_ = 0;  // of kZSobol: the sample's place on the Morton curve
};

inline float Sampler::Sobol(int dimension) const {
  const uint64_t seed = DimensionSeed(dimension);
  uint32_t index = index_;
  int column = dimension;
  if (dimension >= kSobolDimensions) {
    // Beyond the table its dimensions serve again, with the samples in another order.
    column = dimension % kSobolDimensions;
    index = Shuffled(DimensionSeed(dimension / kSobolDimensions + (1 << 20)));
  }
  return Fraction(SobolBits(matrices_, index, column), static_cast<uint32_t>(seed));
}

}  // namespace tessera
