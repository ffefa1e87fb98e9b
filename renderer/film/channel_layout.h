// Where the channels of a frame are kept: the one place that turns a list of channels into positions.
//
// The values of a tile are floats: for each pixel a record of fixed size, then, if there are channels of ids,
// the entries of all sets. A record holds in this order, each group as the frame lists it,
//   sums     channels of the rule kSum
//   nearest  the depth, then the other channels of the rule kNearest
//   ids      for each channel of the rule kIdWeights the size of its set
// The entries are those of the first set of the first pixel, those of its second set, and so on: pairs of id
// and weight by increasing bits of the id. An id is a finite float other than zero, as Cryptomatte makes
// them of its hashes. A record of zeros is the neutral element of every rule: a pixel without samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "renderer/film/channel.h"

namespace tessera {

// What a record consists of: all that is needed to merge, check and encode values.
struct PixelShape {
  uint32_t sums = 0;
  uint32_t nearest = 0;  // with the depth
  uint32_t id_sets = 0;

  bool operator==(const PixelShape&) const = default;
  bool HasOnlySums() const { return nearest == 0 && id_sets == 0; }
  // Floats of a record.
  size_t stride() const { return size_t{sums} + nearest + id_sets; }
  // Floats of a pixel's record and entries, at most.
  size_t floats_max() const { return stride() + size_t{id_sets} * 2 * kIdsPerPixelMax; }
};

// A channel of the finished picture and where its values come from.
struct PictureChannel {
  enum class Source {
    kMean,
    kValue,
    kDepth,
    kSamples,
    kRankedId,
    kRankedCoverage,
    kVariance,     // operands: the colour
    kHitMean,      // operands: the weight of hits
    kHitSlope,     // the same
    kDirection,    // operands: X, Y and Z
    kHitVariance,  // operands: the sum, the count of hits
    kRelativeHitVariance,
  };
  std::string name;
  Source source = Source::kMean;
  size_t channel = 0;                // index in the frame's list
  uint32_t rank = 0;                 // of ids: 0 has the largest coverage
  bool is_exact = false;             // written as a 32-bit float, whatever the precision of the file
  std::array<size_t, 3> operands{};  // other channels that the value depends on, as `channel`
};

// The channels that a picture of the frame has, in the order of the frame's list. Channels of ids have
// `cryptomatte_levels` levels of ranks.
std::vector<PictureChannel> PictureChannels(const std::vector<Channel>& channels,
                                            uint32_t cryptomatte_levels);

// What a channel is written with the help of and the frame does not have, for a message; empty if it has all.
std::string MissingOperand(const std::vector<Channel>& channels, const Channel& channel);

class ChannelLayout {
 public:
  // The count of samples needs no room if every pixel gets all samples: the range of a node tells it.
  ChannelLayout(const std::vector<Channel>& channels, bool keeps_counts);

  const PixelShape& shape() const { return shape_; }
  // Position in a record of the channel with this index in the frame's list; nullopt if it needs no room. Of
  // a channel of ids it is that of the size of its set.
  std::optional<size_t> SlotOf(size_t channel) const { return slots_[channel]; }
  // The same by name; nullopt also if there is no such channel.
  std::optional<size_t> SlotOf(const std::string& name) const;
  size_t weight() const { return weight_; }
  // Of the count of samples, if it is kept.
  std::optional<size_t> samples() const { return samples_; }
  // Of R, G and B, as far as the frame has them.
  std::span<const size_t> colors() const { return colors_; }
  // How many of the channel's sets are before it in a record.
  size_t IdSetOf(size_t channel) const { return *slots_[channel] - shape_.sums - shape_.nearest; }

 private:
  void Place(const std::vector<Channel>& channels, MergeRule rule, bool keeps_counts);

  PixelShape shape_;
  std::vector<std::string> names_;
  std::vector<std::optional<size_t>> slots_;  // by index in the frame's list
  size_t weight_ = 0;
  std::optional<size_t> samples_;
  std::vector<size_t> colors_;
};

}  // namespace tessera
