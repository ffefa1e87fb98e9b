// Sobol' points and their randomisations.
#pragma once

#include <bit>
#include <cstdint>

#include "renderer/sampler/sobol_data.h"
#include "renderer/util/hash.h"

namespace tessera {

// Generator matrices, one column per bit of the index. The first two dimensions reach 52 bits of index, for
// sequences that run over all pixels; the others 32.
struct SobolMatrices {
  static constexpr int kColumnsWide = 52;
  static constexpr int kColumns = 32;
  uint32_t wide[2][kColumnsWide];
  uint32_t narrow[kSobolDimensions][kColumns];
  // The columns of several dimensions, whose points are computed together, four bits of the index at a time.
  static constexpr int kLanes = 8;
  struct Block {
    static constexpr int kDigitBits = 4;
    // The exclusive-or of the columns that the bits of a digit of the index name, by digit and its value.
    alignas(32) uint32_t sums[kColumns / kDigitBits][1 << kDigitBits][kLanes];

    // Sets column k of one lane. Columns are to be set in their order.
    void SetColumn(int k, int lane, uint32_t column) {
      auto& digit = sums[k / kDigitBits];
      const int first = 1 << k % kDigitBits;
      for (int value = first; value < 2 * first; ++value)
        digit[value][lane] = digit[value - first][lane] ^ column;
    }
  };
  // `narrow` with the bits of each column reversed. Points are exclusive-ors of columns, so that those of
  // this matrix are the points of `narrow` reversed. Dimension d is lane d % kLanes of block d / kLanes.
  static_assert(kSobolDimensions % kLanes == 0);
  Block reversed[kSobolDimensions / kLanes];
};
// Computed once from sobol_data.h.
const SobolMatrices& Matrices();

// The exclusive-or of the columns that the bits of `index` name.
inline uint32_t SobolPoint(const uint32_t* columns, uint32_t index) {
  uint32_t v = 0;
  for (; index != 0; index &= index - 1) v ^= columns[std::countr_zero(index)];
  return v;
}
// Point `index` of a dimension below kSobolDimensions, as 32 bits of a fraction.
inline uint32_t SobolBits(const SobolMatrices& matrices, uint32_t index, int dimension) {
  return SobolPoint(matrices.narrow[dimension], index);
}
// The same for dimension 0 or 1 and indices of up to 52 bits.
inline uint32_t SobolBitsWide(const SobolMatrices& matrices, uint64_t index, int dimension) {
  uint32_t v = 0;
  for (; index != 0; index &= index - 1) v ^= matrices.wide[dimension][std::countr_zero(index)];
  return v;
}

// Reverses the 32 bits.
inline uint32_t ReverseBits(uint32_t v) {
  v = __builtin_bswap32(v);
  v = ((v & 0x0f0f0f0fu) << 4) | ((v >> 4) & 0x0f0f0f0fu);
  v = ((v & 0x33333333u) << 2) | ((v >> 2) & 0x33333333u);
  return ((v & 0x55555555u) << 1) | ((v >> 1) & 0x55555555u);
}

// A random permutation in which every bit depends on the bits below it only (Laine and Karras 2011, constants
// of N. Vegdahl 2021).
inline uint32_t PermuteUpwards(uint32_t v, uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

// Owen's nested uniform scrambling of the bits of a fraction, approximated by a hash.
inline uint32_t FastOwenScramble(uint32_t v, uint32_t seed) {
  return ReverseBits(PermuteUpwards(ReverseBits(v), seed));
}

// Owen's scrambling as defined: the flip of each bit is a hash of all bits above it.
uint32_t OwenScramble(uint32_t v, uint32_t seed);

enum class Randomization { kNone, kPermuteDigits, kFastOwen, kOwen };

inline uint32_t Randomize(Randomization randomization, uint32_t v, uint32_t seed) {
  switch (randomization) {
    case Randomization::kNone: return v;
    case Randomization::kPermuteDigits: return v ^ seed;
    case Randomization::kFastOwen: return FastOwenScramble(v, seed);
    case Randomization::kOwen: return OwenScramble(v, seed);
  }
  return v;
}

inline float RandomizedFraction(Randomization randomization, uint32_t bits, uint32_t seed) {
  return UniformFloat(Randomize(randomization, bits, seed));
}

// RandomizedFraction of SobolBits.
inline float RandomizedSobol(const SobolMatrices& matrices, Randomization randomization, uint32_t index,
                             int dimension, uint32_t seed) {
  if (randomization == Randomization::kFastOwen) {
    // FastOwenScramble without its first reversal, which the columns already have.
    const SobolMatrices::Block& block = matrices.reversed[dimension / SobolMatrices::kLanes];
    uint32_t reversed = 0;
    for (int digit = 0; index != 0; index >>= SobolMatrices::Block::kDigitBits, ++digit)
      reversed ^= block.sums[digit][index % (1 << SobolMatrices::Block::kDigitBits)]
                            [dimension % SobolMatrices::kLanes];
    return UniformFloat(ReverseBits(PermuteUpwards(reversed, seed)));
  }
  return RandomizedFraction(randomization, SobolBits(matrices, index, dimension), seed);
}

// RandomizedSobol by Randomization::kFastOwen for the kLanes dimensions of a block of reversed columns, each
// with its own seed. `seeds` and `values` are aligned to 32 bytes.
void FastOwenSobolBlock(const SobolMatrices::Block& block, uint32_t index, const uint32_t* seeds,
                        float* values);

// A nested shuffle of sample indices: aligned blocks of a power of two go to aligned blocks, so that every
// prefix is stratified as well as before.
inline uint32_t ShuffledIndex(uint32_t index, uint64_t seed) {
  return FastOwenScramble(index, static_cast<uint32_t>(seed >> 32));
}

// Element `i` of a random permutation of 0 ... count - 1 (Kensler 2013).
uint32_t PermutationElement(uint32_t i, uint32_t count, uint32_t seed);

}  // namespace tessera
