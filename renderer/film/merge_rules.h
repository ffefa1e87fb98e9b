// The values of a tile (channel_layout.h) as the merge rules of channel.h treat them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/film/channel_layout.h"
#include "renderer/film/pixel_mask.h"
#include "renderer/util/result.h"

namespace tessera {

// An entry of a set of ids: what was hit and the sum of the filter weights of the samples that hit it.
struct IdWeight {
  float id = 0;
  float weight = 0;
  bool operator==(const IdWeight&) const = default;
};
using IdSet = std::vector<IdWeight>;  // by increasing bits of the id

// The largest value of one sample that is added up. Larger ones count as this, so that no sum of a picture
// overflows: kSamplesPerPixelMax times this power of two is below FLT_MAX, and no rounding exceeds it.
constexpr float kSampleValueMax = 0x1p106f;

// Limits the values of one sample that are added up.
inline void LimitSample(const PixelShape& shape, float* record) {
  for (size_t i = 0; i < shape.sums; ++i)
    record[i] = std::clamp(record[i], -kSampleValueMax, kSampleValueMax);
}

// Sums and nearest values of one pixel: the record of the left node becomes that of the parent. The sizes of
// its sets of ids stay as they are.
inline void MergeRecord(const PixelShape& shape, float* left, const float* right) {
  size_t i = 0;
  for (; i + 4 <= shape.sums; i += 4) {  // four at a time, as a vector register holds them
    const float sum[4] = {left[i] + right[i], left[i + 1] + right[i + 1], left[i + 2] + right[i + 2],
                          left[i + 3] + right[i + 3]};
    for (size_t k = 0; k < 4; ++k) left[i + k] = sum[k];
  }
  for (; i < shape.sums; ++i) left[i] = left[i] + right[i];
  if (shape.nearest == 0) return;
  const float left_depth = left[i], right_depth = right[i];
  if (right_depth == 0 || (left_depth != 0 && left_depth <= right_depth)) return;
  for (; i < size_t{shape.sums} + shape.nearest; ++i) left[i] = right[i];
}

// The parent of two sets. `merged` must be another object than both.
void MergeIds(std::span<const IdWeight> left, std::span<const IdWeight> right, IdSet& merged);

// The node of the whole from those of the left and right half of a tile's samples. `parent` may be one of
// them, and has their size.
void MergeSiblings(const PixelShape& shape, size_t pixels, const std::vector<float>& left,
                   const std::vector<float>& right, std::vector<float>& parent);

// An error unless these can be the values of that many pixels: their number, that of the entries, ids in
// order and without duplicates, depths that are not negative.
Result<void> CheckValues(const PixelShape& shape, size_t pixels, std::span<const float> values);

// Whether all values are finite, and those that are added up no larger than that many samples can make them.
bool AreInRange(const PixelShape& shape, size_t pixels, std::span<const float> values, uint32_t samples);

// Sets all pixels that the mask does not have to zero.
void KeepPixels(const PixelShape& shape, size_t pixels, const PixelMask& kept, std::vector<float>& values);

// Walks over the entries of a tile's sets, in order of pixels and sets.
class IdReader {
 public:
  IdReader(const PixelShape& shape, size_t pixels, std::span<const float> values)
      : rest_(values.subspan(shape.stride() * pixels)) {}
  // The next set, of a size that its record tells.
  IdSet Next(float size) {
    IdSet set(static_cast<size_t>(size));
    for (size_t i = 0; i < set.size(); ++i) set[i] = {rest_[2 * i], rest_[2 * i + 1]};
    rest_ = rest_.subspan(2 * set.size());
    return set;
  }

 private:
  std::span<const float> rest_;
};

}  // namespace tessera
