#include "renderer/film/merger.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

// left += right, value by value: the parent of two siblings.
void AddInto(std::vector<float>& left, const std::vector<float>& right) {
  for (size_t i = 0; i < left.size(); ++i) left[i] = left[i] + right[i];
}

bool IsInside(const std::vector<SampleRange>& partition, SampleRange range) {
  return std::ranges::any_of(partition, [&](SampleRange term) { return term.Contains(range); });
}

// Appends the largest dyadic parts of `range` that none of the disjoint `nodes` covers.
template <typename Nodes>
void AppendMissing(const Nodes& nodes, SampleRange range, std::vector<SampleRange>& missing) {
  bool overlaps = false;
  for (const auto& [held, sums] : nodes) {
    if (held.Contains(range)) return;
    overlaps = overlaps || held.Overlaps(range);
  }
  if (!overlaps) {
    missing.push_back(range);
    return;
  }
  AppendMissing(nodes, range.Left(), missing);
  AppendMissing(nodes, range.Right(), missing);
}

// The sum, in order, of the nodes that make a prefix [0, n) if there is one, of all nodes otherwise.
struct NodeSum {
  std::vector<float> sums;
  uint32_t samples = 0;
};

template <typename Nodes>
NodeSum SumOfNodes(const Nodes& nodes) {
  NodeSum total;
  const bool has_prefix = !nodes.empty() && nodes.begin()->first.begin == 0;
  for (const auto& [range, sums] : nodes) {
    if (has_prefix && range.begin != total.samples) break;
    total.samples += range.size;
    if (total.sums.empty()) {
      total.sums = sums;
    } else {
      AddInto(total.sums, sums);
    }
  }
  return total;
}

// The pixels that have every sample of both halves.
PixelMask FullPixels(const FrameSpec& spec, const TileHalves& halves) {
  std::vector<bool> full(halves.left.size() / spec.channels.size());
  for (size_t p = 0; p < full.size(); ++p) {
    full[p] = SamplesOf(spec, halves, p) == static_cast<float>(halves.samples);
  }
  return PixelMask::Of(full);
}

template <typename Nodes>
uint32_t SampleCount(const Nodes& nodes) {
  uint32_t count = 0;
  for (const auto& [range, sums] : nodes) count += range.size;
  return count;
}

}  // namespace

Merger::Merger(FrameSpec spec) : spec_(std::move(spec)) {
  TESSERA_CHECK(spec_.Check().has_value());
  partition_ = DyadicPartition(spec_.samples_per_pixel);
  tiles_.resize(static_cast<size_t>(spec_.TileCount()));
  for (int t = 0; t < spec_.TileCount(); ++t) {
    Tile& tile = tiles_[static_cast<size_t>(t)];
    tile.goal = FirstGoal(spec_);
    tile.samples_total = static_cast<uint64_t>(spec_.TileBounds(t).area()) * spec_.samples_per_pixel;
  }
  samples_total_ = static_cast<uint64_t>(spec_.crop.area()) * spec_.samples_per_pixel;
}

Result<Merger::Outcome> Merger::Add(int tile_index, RadianceTile result) {
  if (tile_index < 0 || tile_index >= spec_.TileCount()) {
    return Failed(fmt::format("tile {} is not one of the frame's {}", tile_index, spec_.TileCount()));
  }
  if (result.bounds != spec_.TileBounds(tile_index))
    return Failed(fmt::format("tile {}: its bounds are wrong", tile_index));
  if (result.channels != spec_.channel_count() ||
      static_cast<int64_t>(result.sums.size()) != result.bounds.area() * result.channels) {
    return Failed(
        fmt::format("tile {}: its channels are not the frame's {}", tile_index, spec_.channel_count()));
  }
  if (!result.range.IsDyadic() || !IsInside(partition_, result.range)) {
    return Failed(
        fmt::format("tile {}: samples {} are no part of the frame", tile_index, result.range.Text()));
  }
  if (Has(tile_index, result.range)) return Outcome::kDuplicate;

  Tile& tile = tiles_[static_cast<size_t>(tile_index)];
  const auto pixels = static_cast<uint64_t>(result.bounds.area());
  const int width = result.bounds.width();
  samples_merged_ -= SamplesOfNodes(tile.nodes, pixels);
  samples_total_ -= tile.samples_total;
  // What was wanted of earlier samples is there.
  if (spec_.IsAdaptive() && result.range.begin > 0) KeepPixels(spec_, tile.goal.pixels, result.sums);
  Insert(tile.nodes, std::move(result));
  Decide(tile, width);
  samples_merged_ += SamplesOfNodes(tile.nodes, pixels);
  samples_total_ += tile.samples_total;
  return Outcome::kMerged;
}

uint64_t Merger::SamplesOfNodes(const Nodes& nodes, uint64_t pixels) const {
  if (!spec_.IsAdaptive()) return SampleCount(nodes) * pixels;
  double count = 0;  // exact: whole numbers far below 2^53
  for (const auto& [range, sums] : nodes) {
    for (size_t p = 0; p < sums.size(); p += spec_.channels.size()) count += SamplesOf(spec_, &sums[p]);
  }
  return static_cast<uint64_t>(count);
}

Result<Merger::Outcome> Merger::Add(TileNode node) {
  if (node.tile >= tiles_.size())
    return Failed(fmt::format("tile {} is not one of the frame's {}", node.tile, tiles_.size()));
  const int tile = static_cast<int>(node.tile);
  return Add(tile,
             RadianceTile{spec_.TileBounds(tile), node.range, spec_.channel_count(), std::move(node.sums)});
}

// Whether the halves of `range` decide if the tile stops at its end.
bool Merger::IsDecision(SampleRange range) const {
  return range.begin == 0 && range.size > FirstUnitMax(spec_);
}

void Merger::Insert(Nodes& nodes, RadianceTile result) const {
  std::erase_if(nodes, [&](const auto& node) { return result.range.Contains(node.first); });
  // Siblings become their parent as long as the parent is a part of the frame's sum.
  SampleRange range = result.range;
  std::vector<float> sums = std::move(result.sums);
  while (IsInside(partition_, range.Parent()) && !IsDecision(range.Parent())) {
    const auto sibling = nodes.find(range.Sibling());
    if (sibling == nodes.end()) break;
    std::vector<float> other = std::move(sibling->second);
    nodes.erase(sibling);
    if (!range.IsLeft()) std::swap(sums, other);
    AddInto(sums, other);
    range = range.Parent();
  }
  nodes.emplace(range, std::move(sums));
}

// Takes the decisions that the nodes allow, in order of the doublings.
void Merger::Decide(Tile& tile, int width) const {
  Nodes& nodes = tile.nodes;
  while (true) {
    const auto left = nodes.begin();
    const SampleRange whole = left->first.Parent();
    if (left->first.begin != 0 || !IsDecision(whole)) return;
    // Halves that were joined belong to a tile that went on: with which pixels is known when the next
    // doubling is there.
    while (tile.goal.samples < whole.size && !tile.goal.is_final)
      tile.goal = NextGoal(spec_, tile.goal.samples, {});
    const auto right = nodes.find(left->first.Sibling());
    if (right == nodes.end()) return;
    const TileHalves halves{whole.size, width, left->second, right->second};
    if (tile.goal.samples == whole.size && !tile.goal.is_final) {
      GoOn(tile, halves, NoisyPixels(spec_, halves));
      if (tile.goal.samples == whole.size) return;
    } else if (whole.size == spec_.samples_per_pixel) {
      tile.goal.pixels = FullPixels(spec_, halves);
      tile.samples_total = SamplesToCome(halves, tile.goal.pixels);
    }
    if (!nodes.contains(whole.Sibling())) return;
    std::vector<float> sums = std::move(left->second);
    AddInto(sums, right->second);
    nodes.erase(left, std::next(right));
    nodes.emplace(whole, std::move(sums));
  }
}

// With these pixels; the tile stops if there are none.
void Merger::GoOn(Tile& tile, const TileHalves& halves, PixelMask pixels) const {
  tile.samples_total = SamplesToCome(halves, pixels);
  const auto beyond = std::next(tile.nodes.begin(), 2);
  if (pixels.Count(halves.left.size() / spec_.channels.size()) == 0) {
    tile.nodes.erase(beyond, tile.nodes.end());
    tile.goal = {halves.samples, true, {}};
    return;
  }
  for (auto node = beyond; node != tile.nodes.end(); ++node) KeepPixels(spec_, pixels, node->second);
  tile.goal = NextGoal(spec_, halves.samples, std::move(pixels));
}

// Of a tile: as many as `pixels` may come to, and what the others have.
uint64_t Merger::SamplesToCome(const TileHalves& halves, const PixelMask& pixels) const {
  double count = 0;
  for (size_t p = 0; p < halves.left.size() / spec_.channels.size(); ++p) {
    count += pixels.Has(p) ? static_cast<double>(spec_.samples_per_pixel) : SamplesOf(spec_, halves, p);
  }
  return static_cast<uint64_t>(count);
}

bool Merger::Has(int tile_index, SampleRange range) const {
  TESSERA_CHECK(tile_index >= 0 && tile_index < spec_.TileCount());
  const Tile& tile = tiles_[static_cast<size_t>(tile_index)];
  if (tile.goal.is_final && range.begin >= tile.goal.samples) return true;
  uint32_t held = 0;
  for (const auto& [node, sums] : tile.nodes) {
    if (node.Contains(range)) return true;
    if (range.Contains(node)) held += node.size;
  }
  return held == range.size;
}

const TileGoal& Merger::Goal(int tile) const {
  TESSERA_CHECK(tile >= 0 && tile < spec_.TileCount());
  return tiles_[static_cast<size_t>(tile)].goal;
}

std::vector<SampleRange> Merger::Missing(int tile) const {
  std::vector<SampleRange> missing;
  for (SampleRange term : UnitPartition(spec_, Goal(tile).samples))
    AppendMissing(tiles_[static_cast<size_t>(tile)].nodes, term, missing);
  return missing;
}

FramePicture Merger::Picture() const {
  FramePicture picture;
  picture.bounds = spec_.crop;
  picture.channels.assign(spec_.channels.begin(),
                          spec_.channels.begin() + static_cast<std::ptrdiff_t>(spec_.MeanCount()));
  picture.samples_min = spec_.samples_per_pixel;
  const size_t pixels = static_cast<size_t>(spec_.crop.area());
  picture.values.assign(pixels * picture.channels.size(), 0.0f);
  if (spec_.samples_aov) picture.samples.assign(pixels, 0.0f);
  for (int tile = 0; tile < spec_.TileCount(); ++tile) Paint(tile, picture);
  return picture;
}

void Merger::Paint(int tile, FramePicture& picture) const {
  const NodeSum shown = SumOfNodes(tiles_[static_cast<size_t>(tile)].nodes);
  if (shown.samples == 0) {
    picture.samples_min = 0;
    return;
  }
  const size_t means = spec_.MeanCount();
  const PixelBounds bounds = spec_.TileBounds(tile);
  const float* pixel = shown.sums.data();
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    size_t place = static_cast<size_t>(y - spec_.crop.y0) * static_cast<size_t>(spec_.crop.width()) +
                   static_cast<size_t>(bounds.x0 - spec_.crop.x0);
    float* out = &picture.values[place * means];
    for (int x = bounds.x0; x < bounds.x1; ++x, ++place, pixel += spec_.channels.size()) {
      const float weight = pixel[spec_.channels.size() - 1];
      for (size_t c = 0; c < means; ++c) *out++ = weight != 0 ? pixel[c] / weight : 0.0f;
      const uint32_t samples =
          spec_.IsAdaptive() ? static_cast<uint32_t>(SamplesOf(spec_, pixel)) : shown.samples;
      picture.samples_min = std::min(picture.samples_min, samples);
      if (spec_.samples_aov) picture.samples[place] = static_cast<float>(samples);
    }
  }
}

void Merger::VisitNodes(const VisitNode& visit) const {
  for (uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    for (const auto& [range, sums] : tiles_[tile].nodes) visit(tile, range, sums);
  }
}

std::vector<TileNode> Merger::AllNodes() const {
  std::vector<TileNode> all;
  all.reserve(node_count());
  VisitNodes([&](uint32_t tile, SampleRange range, const std::vector<float>& sums) {
    all.push_back({tile, range, sums});
  });
  return all;
}

std::vector<TileNode> Merger::TakeNodes() {
  std::vector<TileNode> all;
  all.reserve(node_count());
  for (uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    for (auto& [range, sums] : tiles_[tile].nodes) all.push_back({tile, range, std::move(sums)});
  }
  *this = Merger(std::move(spec_));
  return all;
}

size_t Merger::node_count() const {
  size_t count = 0;
  for (const Tile& tile : tiles_) count += tile.nodes.size();
  return count;
}

}  // namespace tessera
