// Makes a radiance tile of samples: what a renderer gives its samples to. Owned by one thread.
//
//   TileBuilder builder(layout, bounds, range);
//   for each pixel of the bounds, row by row:
//     builder.SkipPixel(), or for each sample of the range, in order:
//       float* values = builder.Values();           // of the channels, by ChannelLayout::SlotOf; all zeros
//       values[red] = weight * radiance.r; ...      // kSum: a colour or float times the filter weight
//       values[weight_slot] = weight;
//       values[depth] = distance; ...               // kNearest: as it is, if the sample hit anything
//       builder.AddId(set, id, weight);             // kIdWeights: what it hit
//       builder.AddSample();
//     then builder.EndPixel();
//   builder.Take();
// The count of samples is the builder's own. Which channels a renderer fills is its affair: what it leaves
// out stays zero.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/film/channel_layout.h"
#include "renderer/film/merge_rules.h"
#include "renderer/film/radiance_tile.h"

namespace tessera {

class TileBuilder {
 public:
  TileBuilder(const ChannelLayout& layout, PixelBounds bounds, SampleRange range);

  // No sample of the next pixel is wanted.
  void SkipPixel();
  // The values of the sample that AddSample adds next.
  float* Values() { return &levels_[depth_ * stride_]; }
  // What that sample hit, for a channel of ids (ChannelLayout::IdSetOf). An id twice counts twice.
  void AddId(size_t set, float id, float weight);
  void AddSample() {
    LimitSample(shape_, Values());
    // A binary counter of partial nodes, as many as bits are set in the count of samples added: so the sum
    // of the range is its node of the tree.
    for (uint32_t carries = count_++; carries & 1; carries >>= 1) {
      --depth_;
      MergeRecord(shape_, &levels_[depth_ * stride_], &levels_[(depth_ + 1) * stride_]);
      if (shape_.id_sets > 0) MergeSets();
    }
    ++depth_;
    for (size_t i = 0; i < stride_; ++i) levels_[depth_ * stride_ + i] = 0;
  }
  // All samples of the pixel are added.
  void EndPixel();
  // When all pixels of the bounds are there.
  RadianceTile Take();

 private:
  void MergeSets();

  const PixelShape shape_;
  const size_t stride_;
  const std::optional<size_t> samples_;
  RadianceTile tile_;
  std::vector<float> levels_;             // records of partial nodes, then that of the sample to come
  std::vector<std::vector<IdSet>> sets_;  // the sets of the same nodes; none without channels of ids
  std::vector<float> entries_;            // of finished pixels
  IdSet merged_;
  uint32_t count_ = 0;
  size_t depth_ = 0;
};

}  // namespace tessera
