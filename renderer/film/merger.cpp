#include "renderer/film/merger.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/film/merge_rules.h"

namespace tessera {
namespace {

// The sums without those of pixels that are not in the mask.
SharedSums OnlyPixels(const PixelShape& shape, size_t pixel_count, const PixelMask& pixels,
                      const SharedSums& sums) {
  if (pixels.HasAll()) return sums;
  std::vector<float> kept = *sums;
  KeepPixels(shape, pixel_count, pixels, kept);
  return kept;
}

std::string NamesOf(const std::vector<Channel>& channels) {
  std::string names;
  for (const Channel& channel : channels) names += (names.empty() ? "" : " ") + channel.name;
  return names;
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

// The pixels that have every sample of both halves.
PixelMask FullPixels(const ChannelLayout& layout, const TileHalves& halves) {
  std::vector<bool> full(halves.left.size() / layout.shape().stride());
  for (size_t p = 0; p < full.size(); ++p) {
    full[p] = SamplesOf(layout, halves, p) == static_cast<float>(halves.samples);
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

Merger::Merger(FrameSpec spec)
    : spec_(std::move(spec)),
      layout_(spec_.Layout()),
      channels_(std::make_shared<const std::vector<Channel>>(spec_.channels)) {
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

Result<Merger::Outcome> Merger::Add(int tile, RadianceTile result) {
  if (tile < 0 || tile >= spec_.TileCount())
    return Failed(fmt::format("tile {} is not one of the frame's {}", tile, spec_.TileCount()));
  if (result.bounds != spec_.TileBounds(tile))
    return Failed(fmt::format("tile {}: its bounds are wrong", tile));
  if (result.shape != layout_.shape())
    return Failed(fmt::format("tile {}: its channels are not those of the frame", tile));
  return Add(TileNode{static_cast<uint32_t>(tile), result.range, std::move(result.sums)});
}

Result<void> Merger::Check(const TileNode& node) const {
  if (node.tile >= tiles_.size())
    return Failed(fmt::format("tile {} is not one of the frame's {}", node.tile, tiles_.size()));
  if (node.channels != nullptr && node.channels != channels_ && *node.channels != *channels_) {
    return Failed(fmt::format("tile {}: its channels are {}, those of the frame {}", node.tile,
                              NamesOf(*node.channels), NamesOf(*channels_)));
  }
  const auto pixels = static_cast<size_t>(spec_.TileBounds(static_cast<int>(node.tile)).area());
  if (auto ok = CheckValues(layout_.shape(), pixels, *node.sums); !ok)
    return Failed(fmt::format("tile {}: {}", node.tile, ok.error().message));
  if (!node.range.IsDyadic() || !IsInside(partition_, node.range))
    return Failed(fmt::format("tile {}: samples {} are no part of the frame", node.tile, node.range.Text()));
  return {};
}

Result<Merger::Outcome> Merger::Add(TileNode node) {
  if (const auto checked = Check(node); !checked) return checked.error();
  const int index = static_cast<int>(node.tile);
  if (Has(index, node.range)) return Outcome::kDuplicate;

  Tile& tile = tiles_[node.tile];
  const PixelBounds bounds = spec_.TileBounds(index);
  const auto pixels = static_cast<size_t>(bounds.area());
  samples_merged_ -= SamplesOfNodes(tile.nodes, pixels);
  samples_total_ -= tile.samples_total;
  // What was wanted of earlier samples is there.
  if (spec_.IsAdaptive() && node.range.begin > 0)
    node.sums = OnlyPixels(layout_.shape(), pixels, tile.goal.pixels, node.sums);
  CountNoise(tile, pixels, -1);
  Insert(tile, pixels, node.range, std::move(node.sums));
  Decide(tile, bounds.width(), pixels);
  CountNoise(tile, pixels, 1);
  samples_merged_ += SamplesOfNodes(tile.nodes, pixels);
  samples_total_ += tile.samples_total;
  return Outcome::kMerged;
}

void Merger::CountNoise(const Tile& tile, size_t pixels, double sign) {
  if (tile.noise.pixels() == 0) return;
  const auto area = static_cast<double>(pixels);
  noise_sum_ += sign * tile.noise.sum() * area / static_cast<double>(tile.noise.pixels());
  noise_pixels_ += sign * area;
}

std::optional<double> Merger::noise() const {
  if (2 * noise_pixels_ < static_cast<double>(spec_.crop.area())) return std::nullopt;
  return std::max(noise_sum_ / noise_pixels_, 0.0);
}

uint64_t Merger::SamplesOfNodes(const Nodes& nodes, size_t pixels) const {
  if (!spec_.IsAdaptive()) return uint64_t{SampleCount(nodes)} * pixels;
  double count = 0;  // exact: whole numbers far below 2^53
  for (const auto& [range, sums] : nodes) {
    const float* samples = sums->data() + *layout_.samples();
    for (size_t p = 0; p < pixels; ++p) count += samples[p * layout_.shape().stride()];
  }
  return static_cast<uint64_t>(count);
}

// Whether the halves of `range` decide if the tile stops at its end.
bool Merger::IsDecision(SampleRange range) const {
  return range.begin == 0 && range.size > FirstUnitMax(spec_);
}

void Merger::Insert(Tile& tile, size_t pixels, SampleRange range, SharedSums sums) const {
  Nodes& nodes = tile.nodes;
  const size_t records = pixels * layout_.shape().stride();
  std::erase_if(nodes, [&](const auto& node) { return range.Contains(node.first); });
  // Siblings become their parent as long as the parent is a part of the frame's sum.
  std::vector<float> parent;  // empty as long as there is none
  while (IsInside(partition_, range.Parent()) && !IsDecision(range.Parent())) {
    const auto sibling = nodes.find(range.Sibling());
    if (sibling == nodes.end()) break;
    const SharedSums other = std::move(sibling->second);
    nodes.erase(sibling);
    if (parent.empty()) parent = *sums;
    const std::vector<float>& left = range.IsLeft() ? parent : *other;
    const std::vector<float>& right = range.IsLeft() ? *other : parent;
    if (range.Parent().begin == 0)
      tile.noise.Measure(layout_, std::span(left).first(records), std::span(right).first(records), {});
    MergeSiblings(layout_.shape(), pixels, left, right, parent);
    range = range.Parent();
  }
  nodes.emplace(range, parent.empty() ? std::move(sums) : SharedSums(std::move(parent)));
}

// Takes the decisions that the nodes allow, in order of the doublings.
void Merger::Decide(Tile& tile, int width, size_t pixels) const {
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
    const size_t records = pixels * layout_.shape().stride();
    const TileHalves halves{whole.size, width, std::span(*left->second).first(records),
                            std::span(*right->second).first(records)};
    if (tile.goal.samples == whole.size && !tile.goal.is_final) {
      PixelMask noisy = NoisyPixels(layout_, spec_.noise_threshold, halves);
      tile.noise.Measure(layout_, halves.left, halves.right, noisy);
      GoOn(tile, halves, std::move(noisy));
      if (tile.goal.samples == whole.size) return;
    } else if (whole.size == spec_.samples_per_pixel) {
      tile.goal.pixels = FullPixels(layout_, halves);
      tile.noise.Measure(layout_, halves.left, halves.right, {});
      tile.samples_total = SamplesToCome(halves, tile.goal.pixels);
    }
    if (!nodes.contains(whole.Sibling())) return;
    std::vector<float> sums = *left->second;
    MergeSiblings(layout_.shape(), pixels, sums, *right->second, sums);
    nodes.erase(left, std::next(right));
    nodes.emplace(whole, std::move(sums));
  }
}

// With these pixels; the tile stops if there are none.
void Merger::GoOn(Tile& tile, const TileHalves& halves, PixelMask pixels) const {
  tile.samples_total = SamplesToCome(halves, pixels);
  const auto beyond = std::next(tile.nodes.begin(), 2);
  const size_t pixel_count = halves.left.size() / layout_.shape().stride();
  if (pixels.Count(pixel_count) == 0) {
    tile.nodes.erase(beyond, tile.nodes.end());
    tile.goal = {halves.samples, true, {}};
    return;
  }
  for (auto node = beyond; node != tile.nodes.end(); ++node)
    node->second = OnlyPixels(layout_.shape(), pixel_count, pixels, node->second);
  tile.goal = NextGoal(spec_, halves.samples, std::move(pixels));
}

// Pixel samples of a tile: as many as `pixels` may get, and what the others have.
uint64_t Merger::SamplesToCome(const TileHalves& halves, const PixelMask& pixels) const {
  double count = 0;
  for (size_t p = 0; p < halves.left.size() / layout_.shape().stride(); ++p) {
    count += pixels.Has(p) ? static_cast<double>(spec_.samples_per_pixel) : SamplesOf(layout_, halves, p);
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

FrameSnapshot Merger::Snapshot() const {
  std::vector<FrameSnapshot::TileNodes> tiles;
  tiles.reserve(tiles_.size());
  for (const Tile& tile : tiles_) tiles.emplace_back(tile.nodes.begin(), tile.nodes.end());
  return {spec_, std::move(tiles)};
}

void Merger::VisitNodes(const VisitNode& visit) const {
  for (uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    for (const auto& [range, sums] : tiles_[tile].nodes) visit(tile, range, sums);
  }
}

std::vector<TileNode> Merger::AllNodes() const {
  std::vector<TileNode> all;
  all.reserve(node_count());
  VisitNodes([&](uint32_t tile, SampleRange range, const SharedSums& sums) {
    all.push_back({tile, range, sums, channels_});
  });
  return all;
}

std::vector<TileNode> Merger::TakeNodes() {
  std::vector<TileNode> all;
  all.reserve(node_count());
  for (uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    for (auto& [range, sums] : tiles_[tile].nodes) all.push_back({tile, range, std::move(sums), channels_});
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
