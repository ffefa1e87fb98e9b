#include "renderer/denoise/patch_weights.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

constexpr int kPatched = kTile + 2 * kPatchRadius;  // pixels along the side of a tile and its patches
constexpr int kPatchSide = 2 * kPatchRadius + 1;

// How different two pixels may be in units of their standard deviation: k of the paper, squared.
constexpr float kDamping = 0.4f * 0.4f;
// Keeps the ratio finite where there is no noise: a difference of 1 % of white.
constexpr float kVarianceFloor = 1e-4f;
// Weights are (1 - distance / kReach)^8, close to exp(-distance) but 0 from kReach on.
constexpr float kReach = 8;

using PatchedRows = std::array<std::array<float, kPatched>, kPatched>;

// Adds the distances of the pixels of one row to those at an offset in one colour. A difference that the
// variances explain is no distance.
void AddDistances(const float* p, const float* q, const float* variance_p, const float* variance_q,
                  float* distances) {
  for (int i = 0; i < kPatched; ++i) {
    const float difference = p[i] - q[i];
    const float explained = variance_p[i] + std::min(variance_p[i], variance_q[i]);
    distances[i] +=
        (difference * difference - explained) / (kVarianceFloor + kDamping * (variance_p[i] + variance_q[i]));
  }
}

void FindDistances(const Strip& strip, size_t half, const TilePlace& tile, int dx, int dy,
                   PatchedRows& rows) {
  for (int j = 0; j < kPatched; ++j) {
    float* const row = rows[static_cast<size_t>(j)].data();
    std::fill_n(row, kPatched, 0.0f);
    const int x = tile.x0 - kPatchRadius, y = tile.y0 - kPatchRadius + j;
    for (size_t c = 0; c < kColors; ++c) {
      const Plane& colors = strip.halves[half][c];
      const Plane& variance = strip.variance[c];
      AddDistances(colors.At(x, y), colors.At(x + dx, y + dy), variance.At(x, y), variance.At(x + dx, y + dy),
                   row);
    }
  }
}

// Weights of one row of the tile from the distances of the rows of its patches, summed over columns.
void FindWeights(const PatchedRows& rows, int y, float* weights) {
  constexpr float kScale = 1.0f / (kPatchSide * kPatchSide * static_cast<float>(kColors) * kReach);
  std::array<float, kPatched> columns{};
  for (int j = 0; j < kPatchSide; ++j) {
    const int index = y + j;
    const auto& row = rows[static_cast<size_t>(index)];
    for (size_t i = 0; i < kPatched; ++i) columns[i] += row[i];
  }
  std::array<float, kTile> sums{};
  for (size_t i = 0; i < kPatchSide; ++i) {
    for (size_t x = 0; x < kTile; ++x) sums[x] += columns[x + i];
  }
  for (size_t x = 0; x < kTile; ++x) {
    const float distance = std::max(0.0f, sums[x] * kScale);
    const float rest = std::max(0.0f, 1 - distance);
    const float square = rest * rest, fourth = square * square;
    weights[x] = fourth * fourth;
  }
}

}  // namespace

void PatchWeights::Compute(const Strip& strip, size_t half, const TilePlace& tile) {
  PatchedRows rows;
  float* to = weights_.data();
  for (int dy = -kWindowRadius; dy <= kWindowRadius; ++dy) {
    for (int dx = -kWindowRadius; dx <= kWindowRadius; ++dx) {
      FindDistances(strip, half, tile, dx, dy, rows);
      // Columns of the tile for which both pixels are in the picture.
      const int first = std::clamp(-dx - tile.x0, 0, kTile);
      const int last = std::clamp(std::min(tile.width, tile.width - dx) - tile.x0, first, kTile);
      for (int y = 0; y < kTile; ++y, to += kTile) {
        const int py = tile.y0 + y, qy = py + dy;
        if (py >= tile.height || qy < 0 || qy >= tile.height) {
          std::fill_n(to, kTile, 0.0f);
          continue;
        }
        FindWeights(rows, y, to);
        std::fill(to, to + first, 0.0f);
        std::fill(to + last, to + kTile, 0.0f);
      }
    }
  }
}

}  // namespace tessera
