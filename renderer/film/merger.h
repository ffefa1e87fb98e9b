// Adds radiance tiles into a frame. The result depends on the set of tiles added, never on their order or
// copies.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "film/radiance_tile.h"

namespace tessera {

// A finished or partly finished picture: values (sums divided by weights), channels without the weight "W".
struct FramePicture {
  PixelBounds bounds;  // data window
  std::vector<std::string> channels;
  std::vector<float> values;  // [(y * width + x) * channels + c]
  uint32_t samples_min = 0;   // of the tile that has the fewest
};

// Sums of samples `range` of every pixel of a tile, as RadianceTile has them: a node of its tree.
struct TileNode {
  uint32_t tile = 0;
  SampleRange range;
  std::vector<float> sums;

  bool operator==(const TileNode&) const = default;
};

// Not thread safe: the owner calls it from one thread at a time.
class Merger {
 public:
  enum class Outcome { kMerged, kDuplicate };

  explicit Merger(FrameSpec spec);

  const FrameSpec& spec() const { return spec_; }
  // Adds the node `result.range` of tile `tile`. kDuplicate if all its samples are there already. A node that
  // covers nodes already there replaces them: it is their sum. Refuses bounds, range or channel count that
  // are not the frame's.
  Result<Outcome> Add(int tile, RadianceTile result);
  // The same for a node that another merger of the frame gave out.
  Result<Outcome> Add(TileNode node);
  // Whether every sample of `range` of the tile is merged.
  bool Has(int tile, SampleRange range) const;
  // Dyadic ranges of the tile that are not merged, largest first in order of begin.
  std::vector<SampleRange> Missing(int tile) const;
  uint64_t samples_merged() const { return samples_merged_; }  // pixel samples
  uint64_t samples_total() const;
  bool Complete() const { return samples_merged_ == samples_total(); }
  // Of what is merged; a tile with a complete prefix [0, n) shows that, any other what it has; black where
  // nothing.
  FramePicture Picture() const;
  // Nodes held, for the bound on memory.
  size_t node_count() const;
  // Shows every node, by tile and range.
  using VisitNode = std::function<void(uint32_t tile, SampleRange range, const std::vector<float>& sums)>;
  void VisitNodes(const VisitNode& visit) const;
  // All that is merged: added to another merger of the frame they make it equal to this.
  std::vector<TileNode> AllNodes() const;
  // The same, and the merger is empty.
  std::vector<TileNode> TakeNodes();

 private:
  using Nodes = std::map<SampleRange, std::vector<float>>;  // disjoint ranges
  FrameSpec spec_;
  std::vector<SampleRange> partition_;
  std::vector<Nodes> tiles_;
  uint64_t samples_merged_ = 0;
};

}  // namespace tessera
