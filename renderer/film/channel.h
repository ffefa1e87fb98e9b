// The channels of a frame: what is kept of each pixel, by which rule two nodes of its sample tree become
// their parent, and what is written. Positions are computed in channel_layout.h and nowhere else; a new layer
// is a new entry in a frame's list.
//
// Each rule is a function of (left node, right node) alone, and nodes are merged only along the fixed dyadic
// tree of sample indices (sample_range.h). So the node of a range is the same whatever units it was cut into
// and in whatever order they came.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// The numbers are stored and sent: they never change their meaning.
enum class ChannelType : uint32_t {
  kColor = 0,   // one component of a colour; written with the precision of the file
  kWeight = 1,  // the filter weight that sums are divided by; never written
  kCount = 2,   // the number of samples; exact, as it stays below 2^24; written as a 32-bit float
  kFloat = 3,   // any other value; written as a 32-bit float
  kDepth = 4,   // distance to what a sample hit, > 0; 0: nothing was hit, written as infinity
  kIds = 5,     // what the samples hit, as in Cryptomatte (Friedman and Jones 2015): ids and their coverage
  // Of "NAME.C": the squares of what the samples add to the colour "C". Written as the variance of that
  // colour's mean.
  kVariance = 6,
  kHitWeight = 7,  // the filter weight of the samples that hit a surface; never written
  kHitFloat = 8,   // a value of these samples; written as their mean
  kHitSlope = 9,   // the same, written without its sign
  kDirection =
      10,  // a component "NAME.X", "NAME.Y" or "NAME.Z" of a vector, which is written as a unit vector
  kHitCount = 11,  // the number of samples that hit a surface; never written
  kHitSum = 12,    // a value of these samples, whatever their filter weight; never written
  // The squares of the kHitSum "NAME.sum". Written as two channels: NAME, the variance of the samples, and
  // "Relative" NAME, that divided by their mean.
  kHitSquare = 13,
};
constexpr ChannelType kChannelTypeLast = ChannelType::kHitSquare;

enum class MergeRule : uint32_t {
  // left + right. Values are multiplied by the filter weight of their sample, and kVariance by its square,
  // but not counts, kHitSum and kHitSquare.
  kSum = 0,
  // The values of the sample with the least depth, of equal ones those of the lower sample index. A sample
  // that hit nothing is farther than any other. All channels of this rule come from the same sample.
  kNearest = 1,
  // The union of two sets of (id, weight), the weights of the same id added. At most kIdsPerPixelMax ids: of
  // more those of the least absolute weight are dropped, of equal ones the larger ids.
  kIdWeights = 2,
};

// Enough for a pixel of hair or leaves: what is dropped has less than 1/33 of its node.
constexpr uint32_t kIdsPerPixelMax = 32;
// Of a channel of ids, those of the largest weights are written, by rank. A level is four channels of the
// picture with two ranks.
constexpr uint32_t kRanksPerCryptomatteLevel = 2;
constexpr uint32_t kCryptomatteLevelsDefault = 3;  // what the specification and most renderers have
// 16 ids, the most that Blender writes. As twice as many are kept, an id is written with its whole weight
// unless a pixel has more than kIdsPerPixelMax.
constexpr uint32_t kCryptomatteLevelsMax = 8;
static_assert(2 * kRanksPerCryptomatteLevel * kCryptomatteLevelsMax <= kIdsPerPixelMax);

struct Channel {
  std::string name;  // as in the file; a channel of ids NAME is written as NAME00.R, NAME00.G ...
  ChannelType type = ChannelType::kColor;
  MergeRule rule = MergeRule::kSum;
  bool is_written = true;

  bool operator==(const Channel&) const = default;
};

constexpr int kChannelsMax = 256;
constexpr const char* kSamplesChannel = "samples";

// Colours of these names, then the filter weight "W".
std::vector<Channel> ColorsAndWeight(const std::vector<std::string>& names);
// Counts the samples of each pixel.
Channel SamplesChannel(bool is_written);
// The channels of a frame that an earlier release stored or sent by names alone: colours, "samples" if the
// frame is adaptive, "W".
std::vector<Channel> ChannelsFromNames(const std::vector<std::string>& names, bool writes_samples);
// Adds a channel before the filter weight. If one of the same name is kept but not written, or `added` is not
// written, there is still one of them, which is written if any of the two is.
void AddChannel(std::vector<Channel>& channels, Channel added);
// Whether channels of the type only help to write others.
bool IsNeverWritten(ChannelType type);
// Whether it is one of R, G and B.
bool IsColorChannel(const std::string& name);

// Names are unique and legal in OpenEXR; type and rule go together; there is one weight, one depth if any
// channel is that of the nearest sample, and at most one count, which is called "samples". What a channel is
// written with the help of is there. `cryptomatte_levels` is that of the frame.
Result<void> CheckChannels(const std::vector<Channel>& channels, uint32_t cryptomatte_levels);

}  // namespace tessera
