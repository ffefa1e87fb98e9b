#include "renderer/math/distribution.h"

#include <immintrin.h>

#include <bit>

#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr uint32_t kLanes = 8;           // sums that are compared at once; as many pad the end of a table
constexpr uint32_t kCellsPerBucket = 8;  // of a guide table: about this many cells are searched

// Always a power of two, so that u times it is exact.
uint32_t GuideSize(uint32_t cells) {
  return std::bit_ceil(std::max(1u, cells / kCellsPerBucket));
}

// Writes the running sums of `weights`, scaled to end at 1, to `cdf` and returns the mean weight.
double FillCdf(std::span<const float> weights, float* cdf) {
  double total = 0;
  for (const float w : weights) total += w;
  const size_t n = weights.size();
  double sum = 0;
  cdf[0] = 0;
  for (size_t i = 0; i < n; ++i) {
    sum += weights[i];
    const double share = total > 0 ? sum / total : static_cast<double>(i + 1) / static_cast<double>(n);
    cdf[i + 1] = static_cast<float>(share);
  }
  // Cells of weight 0 at the end stay empty: all sums from the last positive weight on are exactly 1.
  return total / static_cast<double>(n);
}

// guide[b] is the cell that holds u = b / size; guide[size] is the last cell with any share.
void FillGuide(const float* cdf, uint32_t cells, uint32_t* guide, uint32_t size) {
  uint32_t cell = 0;
  for (uint32_t b = 0; b <= size; ++b) {
    const float u = static_cast<float>(b) / static_cast<float>(size);
    while (cell + 1 < cells && cdf[cell + 1] <= u && cdf[cell + 1] < 1) ++cell;
    guide[b] = cell;
  }
}

// The cell with cdf[cell] <= u < cdf[cell + 1]. At least kLanes floats follow the last sum in memory.
uint32_t FindCell(const float* cdf, const uint32_t* guide, uint32_t guide_size, float u) {
  const uint32_t bucket = std::min(static_cast<uint32_t>(u * static_cast<float>(guide_size)), guide_size - 1);
  uint32_t low = guide[bucket], high = guide[bucket + 1];
  while (high - low > kLanes) {
    const uint32_t middle = (low + high) / 2;
    if (cdf[middle + 1] <= u)
      low = middle + 1;
    else
      high = middle;
  }
  // How many sums from low + 1 on are not above u, at most high - low of them.
  const __m256 above = _mm256_cmp_ps(_mm256_loadu_ps(cdf + low + 1), _mm256_set1_ps(u), _CMP_GT_OQ);
  const unsigned mask = static_cast<unsigned>(_mm256_movemask_ps(above)) | 1u << (high - low);
  return low + static_cast<uint32_t>(std::countr_zero(mask));
}

uint32_t CellAt(float x, uint32_t cells) {
  return std::min(static_cast<uint32_t>(x * static_cast<float>(cells)), cells - 1);
}

// Where in the unit interval u lies between the sums of `cell`. CellAt of it is `cell`, whatever is rounded.
float PlaceInCell(const float* cdf, uint32_t cells, uint32_t cell, float u) {
  const float share = cdf[cell + 1] - cdf[cell];
  const float offset = share > 0 ? (u - cdf[cell]) / share : 0;
  float x = (static_cast<float>(cell) + offset) / static_cast<float>(cells);
  while (CellAt(x, cells) < cell) x = std::nextafterf(x, 2.0f);
  while (x >= 1 || CellAt(x, cells) > cell) x = std::nextafterf(x, 0.0f);
  return x;
}

float InvertIn(const float* cdf, uint32_t cells, float x) {
  const uint32_t cell = CellAt(x, cells);
  const float offset = std::clamp(x * static_cast<float>(cells) - static_cast<float>(cell), 0.0f, 1.0f);
  return Lerp(offset, cdf[cell], cdf[cell + 1]);
}

bool InUnit(float x) {
  return x >= 0 && x <= 1;
}

}  // namespace

Distribution1D::Distribution1D(std::span<const float> weights)
    : size_(static_cast<uint32_t>(weights.size())) {
  TESSERA_CHECK(!weights.empty() && weights.size() < UINT32_MAX);
  cdf_.resize(size_ + size_t{1} + kLanes);
  mean_ = static_cast<float>(FillCdf(weights, cdf_.data()));
  guide_.resize(GuideSize(size_) + size_t{1});
  FillGuide(cdf_.data(), size_, guide_.data(), GuideSize(size_));
}

Distribution1D::Drawn Distribution1D::Sample(float u) const {
  const uint32_t guide_size = static_cast<uint32_t>(guide_.size() - 1);
  const uint32_t cell = FindCell(cdf_.data(), guide_.data(), guide_size, u);
  const float n = static_cast<float>(size());
  return {PlaceInCell(cdf_.data(), size(), cell, u), Pmf(cell) * n, cell};
}

float Distribution1D::Pdf(float x) const {
  if (!InUnit(x)) return 0;
  return Pmf(CellAt(x, size())) * static_cast<float>(size());
}

float Distribution1D::Invert(float x) const {
  return InvertIn(cdf_.data(), size(), x);
}

Distribution2D::Distribution2D(std::span<const float> weights, uint32_t width, uint32_t height)
    : width_(width), guide_size_(GuideSize(width)) {
  TESSERA_CHECK(width > 0 && height > 0 && weights.size() == size_t{width} * height);
  cdf_.resize((size_t{width} + 1) * height + kLanes);
  guide_.resize((size_t{guide_size_} + 1) * height);
  std::vector<float> row_means(height);
  for (size_t y = 0; y < height; ++y) {
    float* const cdf = &cdf_[y * (size_t{width} + 1)];
    row_means[y] = static_cast<float>(FillCdf(weights.subspan(y * width, width), cdf));
    FillGuide(cdf, width, &guide_[y * (size_t{guide_size_} + 1)], guide_size_);
  }
  rows_ = Distribution1D(row_means);
}

Distribution2D::Drawn Distribution2D::Sample(Point2 u) const {
  const Distribution1D::Drawn row = rows_.Sample(u.y);
  const float* const cdf = &cdf_[row.cell * (size_t{width_} + 1)];
  const uint32_t* const guide = &guide_[row.cell * (size_t{guide_size_} + 1)];
  const uint32_t cell = FindCell(cdf, guide, guide_size_, u.x);
  const float n = static_cast<float>(width_);
  const float pdf = row.pdf * ((cdf[cell + 1] - cdf[cell]) * n);
  return {{PlaceInCell(cdf, width_, cell, u.x), row.x}, pdf, cell, row.cell};
}

float Distribution2D::CellPdf(uint32_t x, uint32_t y) const {
  const float* const cdf = &cdf_[y * (size_t{width_} + 1)];
  return rows_.Pmf(y) * static_cast<float>(height()) * ((cdf[x + 1] - cdf[x]) * static_cast<float>(width_));
}

float Distribution2D::Pdf(Point2 p) const {
  if (!InUnit(p.x) || !InUnit(p.y)) return 0;
  return CellPdf(CellAt(p.x, width_), CellAt(p.y, height()));
}

Point2 Distribution2D::Invert(Point2 p) const {
  const size_t row = CellAt(p.y, height());
  return {InvertIn(&cdf_[row * (size_t{width_} + 1)], width_, p.x), rows_.Invert(p.y)};
}

size_t Distribution2D::bytes() const {
  return cdf_.size() * sizeof(float) + guide_.size() * sizeof(uint32_t);
}

}  // namespace tessera
