#include "coordinator/core/schedule/frame_work.h"

#include <algorithm>
#include <bit>

#include "coordinator/core/schedule/policy.h"
#include "proto/terms.h"
#include "renderer/util/check.h"

namespace tessera {

FrameWork::FrameWork(const FrameSpec& spec, uint32_t samples_done, const PixelBounds& first)
    : samples_per_pixel_(spec.samples_per_pixel), first_unit_max_(FirstUnitMax(spec)) {
  TESSERA_CHECK(samples_done < spec.samples_per_pixel);
  tiles_.resize(static_cast<size_t>(spec.TileCount()));
  for (uint32_t t = 0; t < tiles_.size(); ++t) {
    Tile& tile = tiles_[t];
    const PixelBounds bounds = spec.TileBounds(static_cast<int>(t));
    tile.area = tile.pixel_count = static_cast<uint32_t>(bounds.area());
    tile.goes_first = Overlap(bounds, first);
    tile.goal.samples = samples_done;
    samples_left_ += samples_per_pixel_ - samples_done;
    if (samples_done > 0) tile.done.Add(SampleSet::Interval{0, samples_done});
    SetGoal(t, FirstGoal(spec));
  }
}

void FrameWork::Extend(uint32_t samples_per_pixel) {
  TESSERA_CHECK(first_unit_max_ == samples_per_pixel_ && samples_per_pixel > samples_per_pixel_);
  const uint32_t added = samples_per_pixel - samples_per_pixel_;
  samples_per_pixel_ = first_unit_max_ = samples_per_pixel;
  for (uint32_t t = 0; t < tiles_.size(); ++t) {
    samples_left_ += added;
    SetGoal(t, {samples_per_pixel, true, {}});
  }
}

template <typename Change>
void FrameWork::ChangeOpen(uint32_t tile_index, Change change) {
  Tile& tile = tiles_[tile_index];
  const auto place = [&] {
    return Place{!tile.goes_first, static_cast<int>(std::bit_width(tile.open.First().begin)), tile_index};
  };
  const auto account = [&](double sign) {
    const double pixel_samples = sign * tile.open.Count() * tile.pixel_count;
    if (tile.measured_samples > 0) {
      open_measured_cost_ += pixel_samples * CostPerPixelSample(tile);
    } else {
      open_unmeasured_samples_ += pixel_samples;
    }
  };
  if (!tile.open.empty()) order_.erase(place());
  account(-1);
  change(tile.open);
  account(+1);
  // While the frame begins, the place is the last one.
  if (!tile.open.empty()) order_.insert(order_.end(), place());
}

double FrameWork::CostPerPixelSample(const Tile& tile) const {
  if (tile.measured_samples > 0) return tile.measured_cost / tile.measured_samples;
  return measured_samples_ > 0 ? measured_cost_ / measured_samples_ : 0;
}

uint32_t FrameWork::PieceSize(const Tile& tile, double cost_max) const {
  if (measured_samples_ == 0) return 1;
  const SampleSet::Interval first = tile.open.First();
  const double per_sample = CostPerPixelSample(tile) * tile.pixel_count;
  const double limit = first.begin == 0 ? std::min(cost_max, kFirstPassDuration_s) : cost_max;
  uint32_t size = DyadicSizeMax(first.begin, first.end);
  if (first.begin == 0) size = std::min(size, first_unit_max_);
  while (size > 1 && per_sample * size > limit) size /= 2;
  return size;
}

std::optional<TileSamples> FrameWork::Take(double cost_max, const std::function<bool(uint32_t tile)>& may) {
  for (const auto& [goes_later, level, index] : order_) {
    if (!may(index)) continue;
    const Tile& tile = tiles_[index];
    const TileSamples piece{index, {tile.open.First().begin, PieceSize(tile, cost_max)}};
    ChangeOpen(index, [&](SampleSet& open) { open.Remove(piece.range); });
    return piece;
  }
  return std::nullopt;
}

bool FrameWork::HasOpen(const std::function<bool(uint32_t tile)>& may) const {
  return std::any_of(order_.begin(), order_.end(), [&](const auto& each) { return may(each.tile); });
}

void FrameWork::GiveBack(TileSamples samples, std::span<const SampleRange> held) {
  SampleSet returned;
  returned.Add(samples.range);
  returned.Remove(tiles_[samples.tile].done);
  for (const SampleRange range : held) returned.Remove(range);
  if (returned.empty()) return;
  ChangeOpen(samples.tile, [&](SampleSet& open) {
    for (const auto& interval : returned.intervals()) open.Add(interval);
  });
}

bool FrameWork::TakeExactly(TileSamples samples) {
  if (!tiles_[samples.tile].open.Contains(samples.range)) return false;
  ChangeOpen(samples.tile, [&](SampleSet& open) { open.Remove(samples.range); });
  return true;
}

bool FrameWork::Finish(TileSamples samples) {
  Tile& tile = tiles_[samples.tile];
  if (tile.done.Contains(samples.range)) return false;
  const uint32_t before = tile.done.Count();
  tile.done.Add(samples.range);
  samples_left_ -= tile.done.Count() - before;
  if (tile.open.Overlaps(samples.range)) {
    ChangeOpen(samples.tile, [&](SampleSet& open) { open.Remove(samples.range); });
  }
  return true;
}

bool FrameWork::IsDone(TileSamples samples) const {
  return tiles_[samples.tile].done.Contains(samples.range);
}

bool FrameWork::HasDone(TileSamples samples) const {
  return tiles_[samples.tile].done.Overlaps(samples.range);
}

bool FrameWork::SetGoal(uint32_t tile_index, const TileGoal& goal) {
  Tile& tile = tiles_[tile_index];
  SampleSet opened;
  if (goal.samples > tile.goal.samples) {
    opened.Add(SampleSet::Interval{tile.goal.samples, goal.samples});
    opened.Remove(tile.done);  // a former process may have merged them
    ChangeOpen(tile_index, [&](SampleSet& open) {
      for (const auto& interval : opened.intervals()) open.Add(interval);
      tile.goal = goal;
      tile.pixel_count = static_cast<uint32_t>(goal.pixels.Count(tile.area));
    });
  }
  if (!goal.is_final) return !opened.empty();
  tile.goal.is_final = true;
  if (goal.samples < samples_per_pixel_ && !tile.has_stopped) Stop(tile);
  return !opened.empty();
}

// Samples beyond the goal count as done.
void FrameWork::Stop(Tile& tile) {
  tile.has_stopped = true;
  samples_left_ += tile.done.Count();
  tile.done.Add(SampleSet::Interval{tile.goal.samples, samples_per_pixel_});
  samples_left_ -= tile.done.Count();
}

void FrameWork::RecordCost(TileSamples samples, double cost) {
  Tile& tile = tiles_[samples.tile];
  const double pixel_samples = double{1} * samples.range.size * tile.pixel_count;
  // The change of cost is accounted for as if the open samples were taken out and put back.
  SampleSet open = tile.open;
  ChangeOpen(samples.tile, [](SampleSet& all) { all = {}; });
  tile.measured_samples += pixel_samples;
  tile.measured_cost += cost;
  measured_samples_ += pixel_samples;
  measured_cost_ += cost;
  ChangeOpen(samples.tile, [&](SampleSet& all) { all = std::move(open); });
}

std::optional<double> FrameWork::Cost(TileSamples samples) const {
  if (measured_samples_ == 0) return std::nullopt;
  const Tile& tile = tiles_[samples.tile];
  return CostPerPixelSample(tile) * tile.pixel_count * samples.range.size;
}

std::optional<double> FrameWork::OpenCost() const {
  if (measured_samples_ == 0) return std::nullopt;
  const double unmeasured = open_unmeasured_samples_ * (measured_cost_ / measured_samples_);
  return std::max(0.0, open_measured_cost_ + unmeasured);
}

}  // namespace tessera
