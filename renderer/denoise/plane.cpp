#include "renderer/denoise/plane.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

// Weights of a Gaussian of 1.5 pixels at the distances 0 to 3, which sum to 1 over both sides.
constexpr float kSmoothWeights[kSmoothRadius + 1] = {0.27068f, 0.21674f, 0.11128f, 0.03664f};

}  // namespace

int Mirrored(int i, int size) {
  if (size == 1) return 0;
  const int period = 2 * (size - 1);
  const int place = ((i % period) + period) % period;
  return place < size ? place : period - place;
}

void MirrorRow(Plane& plane, int y, int width, int margin) {
  float* const row = plane.At(0, y);
  for (int i = 1; i <= margin; ++i) {
    row[-i] = row[Mirrored(-i, width)];
    row[width - 1 + i] = row[Mirrored(width - 1 + i, width)];
  }
}

void SmoothSquaredDifferences(const Plane& a, const Plane& b, int y, int width, float scale, Plane& to) {
  float* const smooth = to.At(0, y);
  std::vector<float> column(static_cast<size_t>(width + 2 * kSmoothRadius), 0.0f);
  for (int dy = -kSmoothRadius; dy <= kSmoothRadius; ++dy) {
    const float *const p = a.At(-kSmoothRadius, y + dy), *const q = b.At(-kSmoothRadius, y + dy);
    const float weight = scale * kSmoothWeights[std::abs(dy)];
    for (size_t i = 0; i < column.size(); ++i) column[i] += weight * ((p[i] - q[i]) * (p[i] - q[i]));
  }
  std::fill_n(smooth, width, 0.0f);
  for (int dx = 0; dx <= 2 * kSmoothRadius; ++dx) {
    const float weight = kSmoothWeights[std::abs(dx - kSmoothRadius)];
    const float* const shifted = column.data() + dx;
    for (int x = 0; x < width; ++x) smooth[x] += weight * shifted[x];
  }
}

}  // namespace tessera
