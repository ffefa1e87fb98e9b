#include "renderer/denoise/local_regression.h"

#include <immintrin.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr size_t kTerms = kFeatures + 1;  // of the linear function: a constant and the features
constexpr size_t kProducts = kTerms * (kTerms + 1) / 2;

// Keeps the equations of pixels without weights solvable.
constexpr float kTiny = 1e-6f;

// Added to the diagonal as well, times the variance of the noise of the feature.
constexpr float kNoiseRidge = 16;
constexpr int kNoiseRadius = 2;  // pixels around that it is estimated from

// A value for each pixel of a row of a tile.
using Lanes = std::array<float, kTile>;

// The differences of the features of the pixels at (dx, dy) from those of row y, and before them 1.
void FindTerms(const std::array<Plane, kFeatures>& features, int x, int y, int dx, int dy,
               std::array<Lanes, kTerms>& terms) {
  terms[0].fill(1);
  for (size_t i = 0; i < kFeatures; ++i) {
    const float* const p = features[i].At(x, y);
    const float* const q = features[i].At(x + dx, y + dy);
    for (size_t l = 0; l < kTile; ++l) terms[i + 1][l] = q[l] - p[l];
  }
}

// The variance of the noise of what guides through glass, from the second differences of neighbours. The
// smaller one of both directions is taken, since edges are no noise.
void FindNoise(const std::array<Plane, kSeenFeatures>& beyond, int x, int y,
               std::array<Lanes, kSeenFeatures>& noise) {
  constexpr int kSide = 2 * kNoiseRadius + 1;
  // A second difference has 3 / 2 of the variance of a value.
  constexpr float kScale = 1 / (1.5f * kSide * kSide);
  for (size_t i = 0; i < kSeenFeatures; ++i) {
    Lanes sum{};
    for (int dy = -kNoiseRadius; dy <= kNoiseRadius; ++dy) {
      const float *const above = beyond[i].At(x, y + dy - 1), *const below = beyond[i].At(x, y + dy + 1);
      const float* const row = beyond[i].At(x - 1, y + dy);
      for (int dx = -kNoiseRadius; dx <= kNoiseRadius; ++dx) {
        const float *const up = above + dx, *const down = below + dx, *const left = row + dx;
        for (size_t l = 0; l < kTile; ++l) {
          const float along = left[l + 1] - 0.5f * (left[l] + left[l + 2]);
          const float across = left[l + 1] - 0.5f * (up[l] + down[l]);
          sum[l] += std::min(along * along, across * across);
        }
      }
    }
    for (size_t l = 0; l < kTile; ++l) noise[i][l] = sum[l] * kScale;
  }
}

bool AnyWeight(const float* weights) {
  __m256 any = _mm256_setzero_ps();  // weights are not negative
  for (size_t l = 0; l < kTile; l += kWide) any = _mm256_or_ps(any, _mm256_loadu_ps(weights + l));
  return _mm256_movemask_ps(_mm256_cmp_ps(any, _mm256_setzero_ps(), _CMP_NEQ_OQ)) != 0;
}

}  // namespace

// The normal equations of the pixels of a row. Products are those of a symmetric matrix: row i, column j <= i
// at i (i + 1) / 2 + j; they become its Cholesky factor.
struct LocalRegression::Row {
  Row(size_t signals, float ridge_of_features) : ridge(ridge_of_features), solutions(signals) {}

  const float ridge;
  std::array<Lanes, kSeenFeatures> noise;  // of FindNoise
  std::array<Lanes, kProducts> products;
  // Of each signal: right sides, then solutions.
  std::vector<std::array<Lanes, kTerms>> solutions;

  static size_t At(size_t i, size_t j) { return i * (i + 1) / 2 + j; }

  void Clear() {
    for (Lanes& lanes : products) lanes.fill(0);
    for (auto& signal : solutions) {
      for (Lanes& lanes : signal) lanes.fill(0);
    }
  }
  void Add(const std::array<Lanes, kTerms>& terms, const float* weights,
           const std::vector<const float*>& signals) {
    for (size_t i = 0; i < kTerms; ++i) {
      Lanes weighted;
      for (size_t l = 0; l < kTile; ++l) weighted[l] = weights[l] * terms[i][l];
      for (size_t j = 0; j <= i; ++j) {
        Lanes& sum = products[At(i, j)];
        for (size_t l = 0; l < kTile; ++l) sum[l] += weighted[l] * terms[j][l];
      }
      for (size_t s = 0; s < solutions.size(); ++s) {
        Lanes& sum = solutions[s][i];
        for (size_t l = 0; l < kTile; ++l) sum[l] += weighted[l] * signals[s][l];
      }
    }
  }
  void Solve() {
    Factorize();
    for (auto& signal : solutions) Substitute(signal);
  }

 private:
  void Factorize() {
    const Lanes total = products[0];
    for (size_t l = 0; l < kTile; ++l) products[0][l] += kTiny;
    for (size_t i = 1; i < kTerms; ++i) {
      for (size_t l = 0; l < kTile; ++l) products[At(i, i)][l] += ridge * total[l] + kTiny;
    }
    for (size_t i = 0; i < kSeenFeatures; ++i) {
      for (size_t l = 0; l < kTile; ++l)
        products[At(i + 1, i + 1)][l] += kNoiseRidge * noise[i][l] * total[l];
    }
    for (size_t i = 0; i < kTerms; ++i) {
      for (size_t j = 0; j <= i; ++j) {
        Lanes& entry = products[At(i, j)];
        for (size_t k = 0; k < j; ++k) Subtract(products[At(i, k)], products[At(j, k)], entry);
        if (i == j) {
          // Rounding must not make it negative.
          for (float& value : entry) value = std::sqrt(std::max(value, kTiny));
        } else {
          Divide(products[At(j, j)], entry);
        }
      }
    }
  }
  void Substitute(std::array<Lanes, kTerms>& right) const {
    for (size_t i = 0; i < kTerms; ++i) {
      for (size_t k = 0; k < i; ++k) Subtract(products[At(i, k)], right[k], right[i]);
      Divide(products[At(i, i)], right[i]);
    }
    for (size_t i = kTerms; i-- > 0;) {
      for (size_t k = i + 1; k < kTerms; ++k) Subtract(products[At(k, i)], right[k], right[i]);
      Divide(products[At(i, i)], right[i]);
    }
  }
  static void Subtract(const Lanes& a, const Lanes& b, Lanes& from) {
    for (size_t l = 0; l < kTile; ++l) from[l] -= a[l] * b[l];
  }
  static void Divide(const Lanes& by, Lanes& lanes) {
    for (size_t l = 0; l < kTile; ++l) lanes[l] /= by[l];
  }
};

LocalRegression::LocalRegression(size_t signals, float ridge) : row_(std::make_unique<Row>(signals, ridge)) {}
LocalRegression::~LocalRegression() = default;

void LocalRegression::Fit(const Strip& strip, const std::vector<const Plane*>& signals, const TilePlace& tile,
                          const PatchWeights& weights, TileContributions& contributions) {
  std::array<Lanes, kTerms> terms;
  std::vector<const float*> values(signals.size());
  // Calls `body` for each offset at which a pixel of row y has a weight.
  const auto for_window = [&](int y, const auto& body) {
    for (int dy = -kWindowRadius; dy <= kWindowRadius; ++dy) {
      for (int dx = -kWindowRadius; dx <= kWindowRadius; ++dx) {
        const float* const w = weights.Row(dx, dy, y);
        if (!AnyWeight(w)) continue;
        FindTerms(strip.features, tile.x0, tile.y0 + y, dx, dy, terms);
        body(dx, dy, w);
      }
    }
  };
  for (int y = 0; y < std::min(kTile, tile.height - tile.y0); ++y) {
    row_->Clear();
    for_window(y, [&](int dx, int dy, const float* w) {
      for (size_t s = 0; s < signals.size(); ++s) values[s] = signals[s]->At(tile.x0 + dx, tile.y0 + y + dy);
      row_->Add(terms, w, values);
    });
    FindNoise(strip.beyond, tile.x0, tile.y0 + y, row_->noise);
    row_->Solve();
    for_window(y, [&](int dx, int dy, const float* w) {
      const int row_of_window = y + dy + kWindowRadius, column_of_window = dx + kWindowRadius;
      const auto row = static_cast<size_t>(row_of_window);
      const auto column = static_cast<size_t>(column_of_window);
      for (size_t s = 0; s < signals.size(); ++s) {
        const auto& solution = row_->solutions[s];
        Lanes fit = solution[0];
        for (size_t i = 1; i < kTerms; ++i) {
          for (size_t l = 0; l < kTile; ++l) fit[l] += solution[i][l] * terms[i][l];
        }
        float* const sum = &contributions.sums[1 + s][row][column];
        for (size_t l = 0; l < kTile; ++l) sum[l] += w[l] * fit[l];
      }
      float* const sum = &contributions.sums[0][row][column];
      for (size_t l = 0; l < kTile; ++l) sum[l] += w[l];
    });
  }
}

}  // namespace tessera
