#include "renderer/film/tile_builder.h"

#include <algorithm>
#include <bit>

#include "renderer/util/check.h"

namespace tessera {

TileBuilder::TileBuilder(const ChannelLayout& layout, PixelBounds bounds, SampleRange range)
    : shape_(layout.shape()),
      stride_(shape_.stride()),
      samples_(layout.samples()),
      tile_{bounds, range, shape_, {}} {
  TESSERA_CHECK(range.IsDyadic() && bounds.width() > 0 && bounds.height() > 0);
  tile_.sums.reserve(static_cast<size_t>(bounds.area()) * stride_);
  // As many partial nodes as the count of samples has bits, and the sample that is being filled in.
  const size_t levels = static_cast<size_t>(std::bit_width(range.size)) + 1;
  levels_.assign(levels * stride_, 0.0f);
  if (shape_.id_sets > 0) sets_.assign(levels, std::vector<IdSet>(shape_.id_sets));
}

void TileBuilder::SkipPixel() {
  tile_.sums.insert(tile_.sums.end(), stride_, 0.0f);
}

void TileBuilder::AddId(size_t set, float id, float weight) {
  const IdWeight entry{id, std::clamp(weight, -kSampleValueMax, kSampleValueMax)};
  IdSet& ids = sets_[depth_][set];
  MergeIds(ids, {&entry, 1}, merged_);
  std::swap(ids, merged_);
}

void TileBuilder::MergeSets() {
  for (size_t set = 0; set < shape_.id_sets; ++set) {
    IdSet& left = sets_[depth_][set];
    IdSet& right = sets_[depth_ + 1][set];
    MergeIds(left, right, merged_);
    std::swap(left, merged_);
    right.clear();
  }
}

void TileBuilder::EndPixel() {
  TESSERA_CHECK(count_ == tile_.range.size && depth_ == 1);
  if (samples_) levels_[*samples_] = static_cast<float>(count_);
  for (size_t set = 0; set < shape_.id_sets; ++set) {
    IdSet& ids = sets_[0][set];
    levels_[stride_ - shape_.id_sets + set] = static_cast<float>(ids.size());
    for (const IdWeight& each : ids) entries_.insert(entries_.end(), {each.id, each.weight});
    ids.clear();
  }
  tile_.sums.insert(tile_.sums.end(), levels_.begin(),
                    levels_.begin() + static_cast<std::ptrdiff_t>(stride_));
  std::fill_n(levels_.begin(), stride_, 0.0f);
  count_ = 0;
  depth_ = 0;
}

RadianceTile TileBuilder::Take() {
  TESSERA_CHECK(tile_.sums.size() == static_cast<size_t>(tile_.bounds.area()) * stride_);
  tile_.sums.insert(tile_.sums.end(), entries_.begin(), entries_.end());
  return std::move(tile_);
}

}  // namespace tessera
