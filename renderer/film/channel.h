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
};

enum class MergeRule : uint32_t {
  // left + right. Colours and floats are multiplied by the filter weight of their sample and written as mean.
  kSum = 0,
  // The values of the sample with the least depth, of equal ones those of the lower sample index. A sample
  // that hit nothing is farther than any other. All channels of this rule come from the same sample.
  kNearest = 1,
  // The union of two sets of (id, weight), the weights of the same id added. At most kIdsPerPixelMax ids: of
  // more those of the least absolute weight are dropped, of equal ones the larger ids.
  kIdWeights = 2,
};

// Enough for a pixel of hair or leaves: what is dropped has less than 1/33 of its node, while a file holds
// the kIdRanks largest only.
constexpr uint32_t kIdsPerPixelMax = 32;
constexpr uint32_t kIdRanks = 6;  // written for each channel of ids: three layers of Cryptomatte

struct Channel {
  std::string name;  // as in the file; a channel of ids NAME is written as NAME00.R ... NAME02.A
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
// Adds a channel before the filter weight. One of the same name that is kept but not written is written from
// now on.
void AddChannel(std::vector<Channel>& channels, Channel added);
// Whether it is one of R, G and B.
bool IsColorChannel(const std::string& name);

// Names are unique and legal in OpenEXR; type and rule go together; there is one weight, one depth if any
// channel is that of the nearest sample, and at most one count, which is called "samples".
Result<void> CheckChannels(const std::vector<Channel>& channels);

}  // namespace tessera
