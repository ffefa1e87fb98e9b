#include "renderer/color/rgb_table.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr size_t kSize = kRgbTableResolution;
constexpr size_t kStrideX = 3, kStrideY = kStrideX * kSize, kStrideZ = kStrideY * kSize,
                 kStrideMax = kStrideZ * kSize;

constexpr double SmoothStep(double x) {
  return x * x * (3 - 2 * x);
}

// The values of the largest component.
constexpr std::array<float, kSize> MakeLevels() {
  std::array<float, kSize> levels{};
  for (size_t k = 0; k < kSize; ++k) {
    levels[k] = static_cast<float>(SmoothStep(SmoothStep(static_cast<double>(k) / (kSize - 1))));
  }
  return levels;
}
constexpr std::array<float, kSize> kLevels = MakeLevels();

// Solves the colours of one pair of ratios, from a middle level up and down, each starting from its
// neighbour.
void SolveColumn(const SigmoidSolver& solver, size_t largest, double x, double y, SigmoidCoefficients& start,
                 float* column) {
  const auto solve = [&](size_t k, const SigmoidCoefficients& guess) {
    const double level = static_cast<double>(kLevels[k]);
    std::array<double, 3> rgb{};
    rgb[largest] = level;
    rgb[(largest + 1) % 3] = x * level;
    rgb[(largest + 2) % 3] = y * level;
    const SigmoidCoefficients found = solver.Solve(rgb, guess);
    const SigmoidPolynomial polynomial = SigmoidSolver::ToPolynomial(found);
    float* const entry = column + k * kStrideZ;
    entry[0] = polynomial.c0, entry[1] = polynomial.c1, entry[2] = polynomial.c2;
    return found;
  };
  constexpr size_t kMiddle = kSize / 5;
  start = solve(kMiddle, start);
  SigmoidCoefficients guess = start;
  for (size_t k = kMiddle + 1; k < kSize; ++k) guess = solve(k, guess);
  guess = start;
  for (size_t k = kMiddle; k-- > 0;) guess = solve(k, guess);
}

// The level below z, of those that have one above.
size_t LevelBelow(float z) {
  size_t below = 0;
  for (size_t step = kSize / 2; step > 0; step /= 2) {
    if (below + step < kSize && kLevels[below + step] < z) below += step;
  }
  return std::min(below, kSize - 2);
}

__m128 Mix(__m128 a, __m128 b, __m128 t) {
  return _mm_add_ps(_mm_mul_ps(a, _mm_sub_ps(_mm_set1_ps(1), t)), _mm_mul_ps(b, t));
}

}  // namespace

std::vector<float> BuildRgbTable(const SigmoidSolver& solver) {
  std::vector<float> table(kRgbTableFloats + 1);
  for (size_t largest = 0; largest < 3; ++largest) {
    for (size_t j = 0; j < kSize; ++j) {
      SigmoidCoefficients start{};
      for (size_t i = 0; i < kSize; ++i) {
        const double x = static_cast<double>(i) / (kSize - 1), y = static_cast<double>(j) / (kSize - 1);
        SolveColumn(solver, largest, x, y, start,
                    table.data() + largest * kStrideMax + j * kStrideY + i * kStrideX);
      }
    }
  }
  return table;
}

SigmoidPolynomial LookUpRgbTable(const float* table, Vec3 rgb) {
  size_t largest = rgb.y >= rgb.x ? 1 : 0;
  if (rgb.z >= std::max(rgb.x, rgb.y)) largest = 2;
  const float component[5] = {rgb.x, rgb.y, rgb.z, rgb.x, rgb.y};
  const float z = component[largest];
  const float scale = static_cast<float>(kSize - 1) / z;
  const float x = component[largest + 1] * scale, y = component[largest + 2] * scale;
  const size_t i = std::min(static_cast<size_t>(x), kSize - 2),
               j = std::min(static_cast<size_t>(y), kSize - 2);
  const size_t k = LevelBelow(z);
  const __m128 tx = _mm_set1_ps(x - static_cast<float>(i)), ty = _mm_set1_ps(y - static_cast<float>(j));
  const __m128 tz = _mm_set1_ps((z - kLevels[k]) / (kLevels[k + 1] - kLevels[k]));

  const float* const corner = table + largest * kStrideMax + k * kStrideZ + j * kStrideY + i * kStrideX;
  const auto along_x = [&](size_t offset) {
    return Mix(_mm_loadu_ps(corner + offset), _mm_loadu_ps(corner + offset + kStrideX), tx);
  };
  const __m128 below = Mix(along_x(0), along_x(kStrideY), ty);
  const __m128 above = Mix(along_x(kStrideZ), along_x(kStrideZ + kStrideY), ty);
  alignas(16) float c[4];
  _mm_store_ps(c, Mix(below, above, tz));
  return {c[0], c[1], c[2]};
}

}  // namespace tessera
