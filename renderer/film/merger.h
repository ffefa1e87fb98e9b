// Adds radiance tiles into a frame, and says of an adaptive frame which samples it still wants. All of that
// depends on the set of tiles added, never on their order or copies.
//
// The two halves of a doubling of an adaptive frame, from which it is decided which pixels stop there, are
// kept apart until the next doubling is whole: so a merger that is given the nodes of another comes to the
// same decisions, and nothing but nodes needs to be kept anywhere. Pixels that have stopped are zeros in the
// nodes that follow, and each pixel's channel "samples" says how many it has.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "renderer/film/adaptive.h"
#include "renderer/film/radiance_tile.h"

namespace tessera {

// A finished or partly finished picture: values (sums divided by weights), channels without the weight "W".
struct FramePicture {
  PixelBounds bounds;  // data window
  std::vector<std::string> channels;
  std::vector<float> values;   // [(y * width + x) * channels + c]
  std::vector<float> samples;  // of each pixel, if the frame asks for it: those its values are made of
  uint32_t samples_min = 0;    // of the pixel that has the fewest
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
  // Adds the node `result.range` of tile `tile`, of a unit or of another merger. kDuplicate if all its
  // samples are there already, or if the tile has stopped before them. A node that covers nodes already there
  // replaces them: it is their sum. Samples beyond a stop of their pixels are dropped. Refuses bounds, range
  // or channel count that are not the frame's.
  Result<Outcome> Add(int tile, RadianceTile result);
  // The same for a node that another merger of the frame gave out.
  Result<Outcome> Add(TileNode node);
  // Whether every sample of `range` of the tile is merged, or will never be wanted.
  bool Has(int tile, SampleRange range) const;
  // What is wanted of the tile by now.
  const TileGoal& Goal(int tile) const;
  // The ranges that the tile wants by now and that are not merged, as large as units can be, in order.
  std::vector<SampleRange> Missing(int tile) const;
  uint64_t samples_merged() const { return samples_merged_; }  // pixel samples
  // Of pixels that have not stopped: as many as they may come to.
  uint64_t samples_total() const { return samples_total_; }
  bool Complete() const { return samples_merged_ == samples_total_; }
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
  struct Tile {
    Nodes nodes;
    TileGoal goal;
    uint64_t samples_total = 0;  // pixel samples
  };
  bool IsDecision(SampleRange range) const;
  void Insert(Nodes& nodes, RadianceTile result) const;
  void Decide(Tile& tile, int width) const;
  void GoOn(Tile& tile, const TileHalves& halves, PixelMask pixels) const;
  uint64_t SamplesOfNodes(const Nodes& nodes, uint64_t pixels) const;
  uint64_t SamplesToCome(const TileHalves& halves, const PixelMask& pixels) const;
  void Paint(int tile, FramePicture& picture) const;

  FrameSpec spec_;
  std::vector<SampleRange> partition_;
  std::vector<Tile> tiles_;
  uint64_t samples_merged_ = 0, samples_total_ = 0;
};

}  // namespace tessera
