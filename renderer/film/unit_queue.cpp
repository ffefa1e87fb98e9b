#include "renderer/film/unit_queue.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "renderer/film/adaptive.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

uint32_t RangeSizeMax(const FrameSpec& spec, int64_t samples_max) {
  const int64_t size = samples_max / spec.TileBounds(0).area();
  return std::bit_floor(static_cast<uint32_t>(std::clamp<int64_t>(size, 1, kSamplesPerPixelMax)));
}

}  // namespace

UnitQueue::UnitQueue(FrameSpec spec, int64_t samples_max, const ChooseTile& goes_first)
    : merger_(std::move(spec)), range_size_max_(RangeSizeMax(merger_.spec(), samples_max)) {
  tiles_.resize(static_cast<size_t>(merger_.spec().TileCount()));
  std::iota(tiles_.begin(), tiles_.end(), 0);
  if (!goes_first) return;
  std::stable_partition(tiles_.begin(), tiles_.end(),
                        [&](int tile) { return goes_first(merger_.spec().TileBounds(tile)); });
}

std::optional<UnitQueue::Unit> UnitQueue::Take() {
  if (!HasUnit()) return std::nullopt;
  if (open_.empty()) {
    const int tile = tiles_[started_++];
    open_.push_back({tile, 0, merger_.Goal(tile).samples});
  }
  Open& open = open_.back();
  uint32_t size = std::min(range_size_max_, DyadicSizeMax(open.begin, open.end));
  if (open.begin == 0) size = std::min(size, FirstUnitMax(merger_.spec()));
  Unit unit{open.tile, {open.begin, size}, merger_.Goal(open.tile).pixels};
  open.begin += size;
  if (open.begin == open.end) open_.pop_back();
  ++taken_;
  return unit;
}

void UnitQueue::Merge(const Unit& unit, RadianceTile sums) {
  --taken_;
  const uint32_t before = merger_.Goal(unit.tile).samples;
  TESSERA_CHECK(merger_.Add(unit.tile, std::move(sums)).has_value());
  const uint32_t after = merger_.Goal(unit.tile).samples;
  if (after > before) open_.push_back({unit.tile, before, after});
}

}  // namespace tessera
