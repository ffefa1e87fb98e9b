// Merges radiance tiles into a frame and knows which samples of an adaptive frame are still wanted. Both
// depend on the set of tiles added, never on their order or on copies.
//
// It is decided from the two halves of a doubling of an adaptive frame which pixels stop there. The halves
// are kept apart until the next doubling is whole: so a merger that is given the nodes of another comes to
// the same decisions, and nothing but nodes needs to be kept anywhere. Pixels that have stopped are zeros in
// the nodes that follow, and each pixel's channel "samples" counts those it has.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/film/adaptive.h"
#include "renderer/film/frame_snapshot.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/film/shared_sums.h"
#include "renderer/film/tile_noise.h"

namespace tessera {

using SharedChannels = std::shared_ptr<const std::vector<Channel>>;

// The values of samples `range` of every pixel of a tile, as RadianceTile has them: a node of its tree.
struct TileNode {
  uint32_t tile = 0;
  SampleRange range;
  SharedSums sums;
  SharedChannels channels = nullptr;  // that the values have; null: those of the frame

  bool operator==(const TileNode& other) const {
    return tile == other.tile && range == other.range && sums == other.sums;
  }
};

// Not thread safe: the owner calls it from one thread at a time.
class Merger {
 public:
  enum class Outcome { kMerged, kDuplicate };

  explicit Merger(FrameSpec spec);

  const FrameSpec& spec() const { return spec_; }
  const ChannelLayout& layout() const { return layout_; }
  // For nodes of this frame.
  const SharedChannels& channels() const { return channels_; }
  // Adds the node `result.range` of tile `tile`, of a unit or of another merger. kDuplicate if all its
  // samples are there already, or if the tile has stopped before them. A node that covers nodes already there
  // replaces them: it is their sum. Samples beyond a stop of their pixels are dropped. Refuses bounds, range
  // or channels that are not the frame's.
  Result<Outcome> Add(int tile, RadianceTile result);
  // The same for sums that others may hold as well.
  Result<Outcome> Add(TileNode node);
  // Whether every sample of `range` of the tile is merged, or will never be wanted.
  bool Has(int tile, SampleRange range) const;
  // What is wanted of the tile so far.
  const TileGoal& Goal(int tile) const;
  // The ranges that the tile wants so far and that are not merged, as large as units can be, in order.
  std::vector<SampleRange> Missing(int tile) const;
  uint64_t samples_merged() const { return samples_merged_; }  // pixel samples
  // Of pixels that have not stopped: as many as they may come to.
  uint64_t samples_total() const { return samples_total_; }
  // The relMSE that the picture is expected to have, as far as its last doublings show it; nullopt while
  // nothing is known of most of it.
  std::optional<double> noise() const;
  bool Complete() const { return samples_merged_ == samples_total_; }
  // What is merged now. Shares the sums with the merger.
  FrameSnapshot Snapshot() const;
  FramePicture Picture() const { return Snapshot().Picture(); }
  // Nodes held, for the bound on memory.
  size_t node_count() const;
  // Shows every node, by tile and range.
  using VisitNode = std::function<void(uint32_t tile, SampleRange range, const SharedSums& sums)>;
  void VisitNodes(const VisitNode& visit) const;
  // All that is merged: added to another merger of the frame they make it equal to this.
  std::vector<TileNode> AllNodes() const;
  // The same, and the merger is empty.
  std::vector<TileNode> TakeNodes();

 private:
  using Nodes = std::map<SampleRange, SharedSums>;  // disjoint ranges
  struct Tile {
    Nodes nodes;
    TileGoal goal;
    uint64_t samples_total = 0;  // pixel samples
    TileNoise noise;
  };
  Result<void> Check(const TileNode& node) const;
  bool IsDecision(SampleRange range) const;
  void Insert(Tile& tile, size_t pixels, SampleRange range, SharedSums sums) const;
  void CountNoise(const Tile& tile, size_t pixels, double sign);
  void Decide(Tile& tile, int width, size_t pixels) const;
  void GoOn(Tile& tile, const TileHalves& halves, PixelMask pixels) const;
  uint64_t SamplesOfNodes(const Nodes& nodes, size_t pixels) const;
  uint64_t SamplesToCome(const TileHalves& halves, const PixelMask& pixels) const;

  FrameSpec spec_;
  ChannelLayout layout_;
  SharedChannels channels_;
  std::vector<SampleRange> partition_;
  std::vector<Tile> tiles_;
  uint64_t samples_merged_ = 0, samples_total_ = 0;
  double noise_sum_ = 0, noise_pixels_ = 0;  // of all tiles, weighted by their area
};

}  // namespace tessera
