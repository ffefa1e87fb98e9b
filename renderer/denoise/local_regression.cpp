#include "renderer/denoise/local_regression.h"

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera {
namespace {

constexpr size_t kTerms = kFeatures + 1;  // of the linear function: a constant and the features
static_assert(kTerms <= 8, "loops over terms are unrolled 8 times, to hold them in registers");
constexpr size_t kProducts = kTerms * (kTerms + 1) / 2;

// Keeps the equations of pixels without weights solvable.
constexpr float kTiny = 1e-6f;

// Added to the diagonal as well, times the variance of the noise of the feature.
constexpr float kNoiseRidge = 16;
constexpr int kNoiseRadius = 2;  // pixels around that it is estimated from

// A value for each pixel of a row of a tile.
using Lanes = std::array<float, kTile>;

// What the pixels at (dx, dy) from those of row y differ from them by.
class Differences {
 public:
  Differences(const std::array<Plane, kFeatures>& features, int x, int y, int dx, int dy) {
    for (size_t i = 0; i < kFeatures; ++i) {
      from_[i] = features[i].At(x, y);
      to_[i] = features[i].At(x + dx, y + dy);
    }
  }
  // Of kWide pixels from the l-th of the row on.
  __m256 At(size_t feature, size_t l) const {
    return _mm256_sub_ps(_mm256_loadu_ps(to_[feature] + l), _mm256_loadu_ps(from_[feature] + l));
  }

 private:
  std::array<const float*, kFeatures> from_, to_;
};

// Pixels of a window that are added to the equations together: more than one, so that the sums stay in
// registers meanwhile.
constexpr size_t kBatch = 8;

// The pixels at some offsets from those of a row.
struct Batch {
  explicit Batch(size_t signal_count) : signals(signal_count) {}

  // Adds the pixels at (dx, dy) from those of row y.
  void Append(const Strip& strip, const std::vector<const Plane*>& colors, int x, int y, int dx, int dy,
              const float* weights_of_pixels) {
    weights[size] = weights_of_pixels;
    for (size_t s = 0; s < colors.size(); ++s) signals[s][size] = colors[s]->At(x + dx, y + dy);
    const Differences differences(strip.features, x, y, dx, dy);
    terms[size][0].fill(1);
    for (size_t l = 0; l < kTile; l += kWide) {
      for (size_t i = 0; i < kFeatures; ++i) _mm256_storeu_ps(&terms[size][i + 1][l], differences.At(i, l));
    }
    ++size;
  }

  size_t size = 0;
  std::array<const float*, kBatch> weights;
  // 1 and the differences of the features from those of the row.
  std::array<std::array<Lanes, kTerms>, kBatch> terms;
  std::vector<std::array<const float*, kBatch>> signals;
};

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
  void Add(const Batch& batch) {
    AddProducts(batch, std::make_index_sequence<kTerms>());
    for (size_t s = 0; s < solutions.size(); ++s)
      AddTerms<kTerms>(batch, batch.signals[s], solutions[s].data());
  }
  void Solve() {
    Factorize();
    for (auto& signal : solutions) Substitute(signal);
  }
  // Adds the fits at the pixels that differ by `differences`, times weights, to the contributions from
  // (column, row) of the window on.
  void AddFits(const Differences& differences, const float* weights, TileContributions& contributions,
               int row, int column) const {
    const auto y = static_cast<size_t>(row), x = static_cast<size_t>(column);
    for (size_t l = 0; l < kTile; l += kWide) {
      const __m256 weight = _mm256_loadu_ps(weights + l);
      __m256 difference[kFeatures];
#pragma GCC unroll 8
      for (size_t i = 0; i < kFeatures; ++i) difference[i] = differences.At(i, l);
      for (size_t s = 0; s < solutions.size(); ++s) {
        __m256 fit = _mm256_loadu_ps(&solutions[s][0][l]);
#pragma GCC unroll 8
        for (size_t i = 0; i < kFeatures; ++i)
          fit = _mm256_fmadd_ps(_mm256_loadu_ps(&solutions[s][i + 1][l]), difference[i], fit);
        float* const sum = &contributions.sums[1 + s][y][x + l];
        _mm256_storeu_ps(sum, _mm256_fmadd_ps(weight, fit, _mm256_loadu_ps(sum)));
      }
      float* const sum = &contributions.sums[0][y][x + l];
      _mm256_storeu_ps(sum, _mm256_add_ps(weight, _mm256_loadu_ps(sum)));
    }
  }

 private:
  template <size_t... kRow>
  void AddProducts(const Batch& batch, std::index_sequence<kRow...>) {
    const auto add_row = [&]<size_t kIndex>() {
      std::array<const float*, kBatch> row{};
      for (size_t b = 0; b < batch.size; ++b) row[b] = batch.terms[b][kIndex].data();
      AddTerms<kIndex + 1>(batch, row, &products[At(kIndex, 0)]);
    };
    (add_row.template operator()<kRow>(), ...);
  }
  // Adds the first kCount terms, times weights and `factors`, to as many sums.
  template <size_t kCount>
  static void AddTerms(const Batch& batch, const std::array<const float*, kBatch>& factors, Lanes* sums) {
    for (size_t l = 0; l < kTile; l += kWide) {
      __m256 sum[kCount];
#pragma GCC unroll 8
      for (size_t i = 0; i < kCount; ++i) sum[i] = _mm256_loadu_ps(&sums[i][l]);
      for (size_t b = 0; b < batch.size; ++b) {
        const __m256 factor =
            _mm256_mul_ps(_mm256_loadu_ps(batch.weights[b] + l), _mm256_loadu_ps(factors[b] + l));
        const std::array<Lanes, kTerms>& terms = batch.terms[b];
#pragma GCC unroll 8
        for (size_t i = 0; i < kCount; ++i)
          sum[i] = _mm256_fmadd_ps(factor, _mm256_loadu_ps(&terms[i][l]), sum[i]);
      }
#pragma GCC unroll 8
      for (size_t i = 0; i < kCount; ++i) _mm256_storeu_ps(&sums[i][l], sum[i]);
    }
  }
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
  Batch batch(signals.size());
  // Calls `body` for each offset at which a pixel of row y has a weight.
  const auto for_window = [&](int y, const auto& body) {
    for (int dy = -kWindowRadius; dy <= kWindowRadius; ++dy) {
      for (int dx = -kWindowRadius; dx <= kWindowRadius; ++dx) {
        const float* const w = weights.Row(dx, dy, y);
        if (AnyWeight(w)) body(dx, dy, w);
      }
    }
  };
  for (int y = 0; y < std::min(kTile, tile.height - tile.y0); ++y) {
    row_->Clear();
    const auto add_batch = [&] {
      row_->Add(batch);
      batch.size = 0;
    };
    for_window(y, [&](int dx, int dy, const float* w) {
      batch.Append(strip, signals, tile.x0, tile.y0 + y, dx, dy, w);
      if (batch.size == kBatch) add_batch();
    });
    add_batch();
    FindNoise(strip.beyond, tile.x0, tile.y0 + y, row_->noise);
    row_->Solve();
    for_window(y, [&](int dx, int dy, const float* w) {
      row_->AddFits(Differences(strip.features, tile.x0, tile.y0 + y, dx, dy), w, contributions,
                    y + dy + kWindowRadius, dx + kWindowRadius);
    });
  }
}

}  // namespace tessera
