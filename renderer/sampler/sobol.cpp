#include "renderer/sampler/sobol.h"

#include <vector>

namespace tessera {
namespace {

// The starting values of a dimension continued to `columns` by its polynomial's recurrence (Bratley and Fox
// 1988), as direction numbers: the upper 32 bits of m_k / 2^k.
void FillColumns(uint32_t polynomial, const uint16_t* start, int columns, uint32_t* column) {
  const int degree = std::bit_width(polynomial) - 1;
  std::vector<uint64_t> m(columns);
  for (int k = 0; k < columns; ++k) {
    if (k < degree) {
      m[k] = start[k];
    } else {
      m[k] = m[k - degree] ^ (m[k - degree] << degree);
      for (int i = 1; i < degree; ++i) {
        if ((polynomial >> (degree - i)) & 1) m[k] ^= m[k - i] << i;
      }
    }
    column[k] = static_cast<uint32_t>(k < 32 ? m[k] << (31 - k) : m[k] >> (k - 31));
  }
}

SobolMatrices MakeMatrices() {
  SobolMatrices matrices{};
  for (int k = 0; k < SobolMatrices::kColumns; ++k)
    matrices.narrow[0][k] = matrices.wide[0][k] = 1u << (31 - k);
  const uint16_t* start = kSobolStart;
  for (int dimension = 1; dimension < kSobolDimensions; ++dimension) {
    const uint32_t polynomial = kSobolPolynomials[dimension - 1];
    FillColumns(polynomial, start, SobolMatrices::kColumns, matrices.narrow[dimension]);
    if (dimension == 1) FillColumns(polynomial, start, SobolMatrices::kColumnsWide, matrices.wide[1]);
    start += std::bit_width(polynomial) - 1;
  }
  for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
    for (int k = 0; k < SobolMatrices::kColumns; ++k)
      matrices.reversed[dimension][k] = ReverseBits(matrices.narrow[dimension][k]);
  }
  return matrices;
}

}  // namespace

const SobolMatrices& Matrices() {
  static const SobolMatrices matrices = MakeMatrices();
  return matrices;
}

uint32_t OwenScramble(uint32_t v, uint32_t seed) {
  uint32_t result = 0;
  for (int bit = 31; bit >= 0; --bit) {
    const uint32_t above = bit == 31 ? 0 : v >> (bit + 1);
    const uint32_t flip = static_cast<uint32_t>(Hash(seed, bit, above) >> 63);
    result |= (v & (1u << bit)) ^ (flip << bit);
  }
  return result;
}

uint32_t PermutationElement(uint32_t i, uint32_t count, uint32_t seed) {
  const uint32_t mask = std::bit_ceil(count) - 1;
  if (mask == 0) return 0;
  do {  // cycle-walk: a permutation of the next power of two, repeated until the value is in range
    i ^= seed;
    i *= 0xe170893du;
    i ^= seed >> 16;
    i ^= (i & mask) >> 4;
    i ^= seed >> 8;
    i *= 0x0929eb3fu;
    i ^= seed >> 23;
    i ^= (i & mask) >> 1;
    i *= 1 | seed >> 27;
    i *= 0x6935fa69u;
    i ^= (i & mask) >> 11;
    i *= 0x74dcb303u;
    i ^= (i & mask) >> 2;
    i *= 0x9e501cc3u;
    i ^= (i & mask) >> 2;
    i *= 0xc860a3dfu;
    i &= mask;
    i ^= i >> 5;
  } while (i >= count);
  return (i + seed) % count;
}

}  // namespace tessera
