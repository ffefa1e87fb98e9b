#include "film/merger.h"

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
template <typename Nodes>
std::vector<float> SumOfNodes(const Nodes& nodes) {
  std::vector<float> total;
  const bool has_prefix = !nodes.empty() && nodes.begin()->first.begin == 0;
  uint32_t end = 0;
  for (const auto& [range, sums] : nodes) {
    if (has_prefix && range.begin != end) break;
    end = range.end();
    if (total.empty()) {
      total = sums;
    } else {
      AddInto(total, sums);
    }
  }
  return total;
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
}

Result<Merger::Outcome> Merger::Add(int tile, RadianceTile result) {
  if (tile < 0 || tile >= spec_.TileCount()) {
    return Failed(fmt::format("tile {} is not one of the frame's {}", tile, spec_.TileCount()));
  }
  if (result.bounds != spec_.TileBounds(tile))
    return Failed(fmt::format("tile {}: its bounds are wrong", tile));
  if (result.channels != spec_.channel_count() ||
      static_cast<int64_t>(result.sums.size()) != result.bounds.area() * result.channels) {
    return Failed(fmt::format("tile {}: its channels are not the frame's {}", tile, spec_.channel_count()));
  }
  if (!result.range.IsDyadic() || !IsInside(partition_, result.range)) {
    return Failed(fmt::format("tile {}: samples {} are no part of the frame", tile, result.range.Text()));
  }
  if (Has(tile, result.range)) return Outcome::kDuplicate;

  Nodes& nodes = tiles_[static_cast<size_t>(tile)];
  uint32_t replaced = 0;
  for (auto it = nodes.begin(); it != nodes.end();) {
    const bool covered = result.range.Contains(it->first);
    replaced += covered ? it->first.size : 0;
    it = covered ? nodes.erase(it) : std::next(it);
  }
  const uint64_t gained = result.range.size - replaced;
  samples_merged_ += gained * static_cast<uint64_t>(result.bounds.area());

  // Siblings become their parent as long as the parent is a part of the frame's sum.
  SampleRange range = result.range;
  std::vector<float> sums = std::move(result.sums);
  while (IsInside(partition_, range.Parent())) {
    const auto sibling = nodes.find(range.Sibling());
    if (sibling == nodes.end()) break;
    std::vector<float> other = std::move(sibling->second);
    nodes.erase(sibling);
    if (!range.IsLeft()) std::swap(sums, other);
    AddInto(sums, other);
    range = range.Parent();
  }
  nodes.emplace(range, std::move(sums));
  return Outcome::kMerged;
}

Result<Merger::Outcome> Merger::Add(TileNode node) {
  if (node.tile >= tiles_.size())
    return Failed(fmt::format("tile {} is not one of the frame's {}", node.tile, tiles_.size()));
  const int tile = static_cast<int>(node.tile);
  return Add(tile,
             RadianceTile{spec_.TileBounds(tile), node.range, spec_.channel_count(), std::move(node.sums)});
}

bool Merger::Has(int tile, SampleRange range) const {
  TESSERA_CHECK(tile >= 0 && tile < spec_.TileCount());
  const Nodes& nodes = tiles_[static_cast<size_t>(tile)];
  // Nodes are as large as they can be, so a range whose samples are all there lies inside one of them.
  return std::ranges::any_of(nodes, [&](const auto& node) { return node.first.Contains(range); });
}

std::vector<SampleRange> Merger::Missing(int tile) const {
  TESSERA_CHECK(tile >= 0 && tile < spec_.TileCount());
  std::vector<SampleRange> missing;
  for (SampleRange term : partition_) AppendMissing(tiles_[static_cast<size_t>(tile)], term, missing);
  return missing;
}

uint64_t Merger::samples_total() const {
  return static_cast<uint64_t>(spec_.crop.area()) * spec_.samples_per_pixel;
}

FramePicture Merger::Picture() const {
  FramePicture picture;
  picture.bounds = spec_.crop;
  picture.channels.assign(spec_.channels.begin(), spec_.channels.end() - 1);
  picture.samples_min = spec_.samples_per_pixel;
  const size_t written = picture.channels.size();
  picture.values.assign(static_cast<size_t>(spec_.crop.area()) * written, 0.0f);
  for (int tile = 0; tile < spec_.TileCount(); ++tile) {
    const Nodes& nodes = tiles_[static_cast<size_t>(tile)];
    picture.samples_min = std::min(picture.samples_min, SampleCount(nodes));
    const std::vector<float> sums = SumOfNodes(nodes);
    if (sums.empty()) continue;
    const PixelBounds bounds = spec_.TileBounds(tile);
    const float* pixel = sums.data();
    for (int y = bounds.y0; y < bounds.y1; ++y) {
      const int64_t row =
          static_cast<int64_t>(y - spec_.crop.y0) * spec_.crop.width() + (bounds.x0 - spec_.crop.x0);
      float* out = &picture.values[static_cast<size_t>(row) * written];
      for (int x = bounds.x0; x < bounds.x1; ++x, pixel += written + 1) {
        const float weight = pixel[written];
        for (size_t c = 0; c < written; ++c) *out++ = weight != 0 ? pixel[c] / weight : 0.0f;
      }
    }
  }
  return picture;
}

void Merger::VisitNodes(const VisitNode& visit) const {
  for (uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    for (const auto& [range, sums] : tiles_[tile]) visit(tile, range, sums);
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
    for (auto& [range, sums] : tiles_[tile]) all.push_back({tile, range, std::move(sums)});
    tiles_[tile].clear();
  }
  samples_merged_ = 0;
  return all;
}

size_t Merger::node_count() const {
  size_t count = 0;
  for (const Nodes& nodes : tiles_) count += nodes.size();
  return count;
}

}  // namespace tessera
