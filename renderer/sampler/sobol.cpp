#include "renderer/sampler/sobol.h"

#include <immintrin.h>

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

// PermuteUpwards, lane by lane.
__m256i PermuteLanesUpwards(__m256i v, __m256i seed) {
  const auto times = [](__m256i a, uint32_t b) {
    return _mm256_mullo_epi32(a, _mm256_set1_epi32(static_cast<int>(b)));
  };
  v = _mm256_xor_si256(v, times(v, 0x3d20adeau));
  v = _mm256_add_epi32(v, seed);
  v = _mm256_mullo_epi32(v, _mm256_or_si256(_mm256_srli_epi32(seed, 16), _mm256_set1_epi32(1)));
  v = _mm256_xor_si256(v, times(v, 0x05526c56u));
  return _mm256_xor_si256(v, times(v, 0x53a22864u));
}

// ReverseBits, lane by lane: of each byte by a table of half bytes, then the bytes.
__m256i ReverseLaneBits(__m256i v) {
  const __m256i half = _mm256_set1_epi8(15);
  const __m256i reversed_halves =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m256i low = _mm256_shuffle_epi8(reversed_halves, _mm256_and_si256(v, half));
  const __m256i high = _mm256_shuffle_epi8(reversed_halves, _mm256_and_si256(_mm256_srli_epi32(v, 4), half));
  const __m256i bytes = _mm256_or_si256(_mm256_slli_epi32(low, 4), high);
  const __m256i last_first =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  return _mm256_shuffle_epi8(bytes, last_first);
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
    SobolMatrices::Block& block = matrices.reversed[dimension / SobolMatrices::kLanes];
    for (int k = 0; k < SobolMatrices::kColumns; ++k)
      block.SetColumn(k, dimension % SobolMatrices::kLanes, ReverseBits(matrices.narrow[dimension][k]));
  }
  return matrices;
}

}  // namespace

const SobolMatrices& Matrices() {
  static const SobolMatrices matrices = MakeMatrices();
  return matrices;
}

void FastOwenSobolBlock(const SobolMatrices::Block& block, uint32_t index, const uint32_t* seeds,
                        float* values) {
  const auto load = [](const uint32_t* lanes) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(lanes));
  };
  __m256i points = _mm256_setzero_si256();
  using Block = SobolMatrices::Block;
  for (int digit = 0; index != 0; index >>= Block::kDigitBits, ++digit)
    points = _mm256_xor_si256(points, load(block.sums[digit][index % (1 << Block::kDigitBits)]));
  const __m256i bits = ReverseLaneBits(PermuteLanesUpwards(points, load(seeds)));
  // As UniformFloat: 24 bits fit into a signed integer and into a float.
  const __m256 fractions = _mm256_cvtepi32_ps(_mm256_srli_epi32(bits, 8));
  _mm256_store_ps(values, _mm256_mul_ps(fractions, _mm256_set1_ps(0x1p-24f)));
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
