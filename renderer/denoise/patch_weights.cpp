#include "renderer/denoise/patch_weights.h"

#include <immintrin.h>

#include <algorithm>
#include <array>

namespace tessera {
namespace {

constexpr int kPatched = kTile + 2 * kPatchRadius;  // pixels along the side of a tile and its patches

// Keeps the ratio finite where there is no noise: a difference of 1 % of white.
constexpr float kVarianceFloor = 1e-4f;
// Weights are (1 - distance / kReach)^8, close to exp(-distance) but 0 from kReach on.
constexpr float kReach = 8;

using PatchedRows = std::array<std::array<float, kPatched>, kPatched>;

// Adds the distances of the pixels of one row to those at an offset in one colour. A difference that the
// variances explain is no distance.
void AddDistances(const float* p, const float* q, const float* variance_p, const float* variance_q,
                  float damping, float* distances) {
  for (int i = 0; i < kPatched; ++i) {
    const float difference = p[i] - q[i];
    const float explained = variance_p[i] + std::min(variance_p[i], variance_q[i]);
    distances[i] +=
        (difference * difference - explained) / (kVarianceFloor + damping * (variance_p[i] + variance_q[i]));
  }
}

void FindDistances(const Guide& guide, float damping, const TilePlace& tile, int dx, int dy,
                   PatchedRows& rows) {
  for (int j = 0; j < kPatched; ++j) {
    float* const row = rows[static_cast<size_t>(j)].data();
    std::fill_n(row, kPatched, 0.0f);
    const int x = tile.x0 - kPatchRadius, y = tile.y0 - kPatchRadius + j;
    for (size_t c = 0; c < kColors; ++c) {
      const Plane& colors = guide.colors[c];
      const Plane& variance = guide.variance[c];
      AddDistances(colors.At(x, y), colors.At(x + dx, y + dy), variance.At(x, y), variance.At(x + dx, y + dy),
                   damping, row);
    }
  }
}

// Weights of one row of the tile from the distances of the rows of its patches, summed over columns.
void FindWeights(const PatchedRows& rows, int y, int radius, float* weights) {
  const int first = kPatchRadius - radius, last = kPatchRadius + radius;
  const auto pixels = static_cast<float>((2 * radius + 1) * (2 * radius + 1));
  const float scale = 1 / (pixels * static_cast<float>(kColors) * kReach);
  std::array<float, kPatched> columns{};
  for (int j = first; j <= last; ++j) {
    const int index = y + j;
    const auto& row = rows[static_cast<size_t>(index)];
    for (size_t i = 0; i < kPatched; ++i) columns[i] += row[i];
  }
  std::array<float, kTile> sums{};
  for (int i = first; i <= last; ++i) {
    const float* const shifted = columns.data() + i;
    for (size_t x = 0; x < kTile; ++x) sums[x] += shifted[x];
  }
  const __m256 zero = _mm256_setzero_ps(), one = _mm256_set1_ps(1), scales = _mm256_set1_ps(scale);
  for (size_t x = 0; x < kTile; x += kWide) {
    const __m256 distance = _mm256_max_ps(_mm256_mul_ps(_mm256_loadu_ps(&sums[x]), scales), zero);
    const __m256 rest = _mm256_max_ps(_mm256_sub_ps(one, distance), zero);
    const __m256 square = _mm256_mul_ps(rest, rest), fourth = _mm256_mul_ps(square, square);
    _mm256_storeu_ps(weights + x, _mm256_mul_ps(fourth, fourth));
  }
}

}  // namespace

void PatchWeights::Compute(const Guide& guide, const WeightSettings& settings, const TilePlace& tile) {
  const float damping = settings.tolerance * settings.tolerance;
  PatchedRows rows;
  float* to = weights_.data();
  for (int dy = -kWindowRadius; dy <= kWindowRadius; ++dy) {
    for (int dx = -kWindowRadius; dx <= kWindowRadius; ++dx) {
      FindDistances(guide, damping, tile, dx, dy, rows);
      // Columns of the tile for which both pixels are in the picture.
      const int first = std::clamp(-dx - tile.x0, 0, kTile);
      const int last = std::clamp(std::min(tile.width, tile.width - dx) - tile.x0, first, kTile);
      for (int y = 0; y < kTile; ++y, to += kTile) {
        const int py = tile.y0 + y, qy = py + dy;
        if (py >= tile.height || qy < 0 || qy >= tile.height) {
          std::fill_n(to, kTile, 0.0f);
          continue;
        }
        FindWeights(rows, y, settings.patch_radius, to);
        std::fill(to, to + first, 0.0f);
        std::fill(to + last, to + kTile, 0.0f);
      }
    }
  }
}

}  // namespace tessera
