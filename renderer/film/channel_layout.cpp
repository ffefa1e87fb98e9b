#include "renderer/film/channel_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace tessera {
namespace {

using Source = PictureChannel::Source;

PictureChannel ValueChannel(const Channel& channel, size_t index) {
  const Source plain = channel.rule == MergeRule::kSum ? Source::kMean : Source::kValue;
  switch (channel.type) {
    case ChannelType::kColor: return {channel.name, plain, index, 0, false};
    case ChannelType::kDepth: return {channel.name, Source::kDepth, index, 0, true};
    case ChannelType::kCount: return {channel.name, Source::kSamples, index, 0, true};
    case ChannelType::kFloat:
    case ChannelType::kWeight:
    case ChannelType::kIds: break;
  }
  return {channel.name, plain, index, 0, true};
}

// Two ranks to a layer, each an id and its coverage.
void AddRanks(const Channel& channel, size_t index, std::vector<PictureChannel>& picture) {
  constexpr std::array<const char*, 4> kComponents{"R", "G", "B", "A"};
  for (uint32_t i = 0; i < 2 * kIdRanks; ++i) {
    const Source source = i % 2 == 0 ? Source::kRankedId : Source::kRankedCoverage;
    picture.push_back(
        {fmt::format("{}{:02}.{}", channel.name, i / 4, kComponents[i % 4]), source, index, i / 2, true});
  }
}

}  // namespace

std::vector<PictureChannel> PictureChannels(const std::vector<Channel>& channels) {
  std::vector<PictureChannel> picture;
  for (size_t i = 0; i < channels.size(); ++i) {
    if (!channels[i].is_written) continue;
    if (channels[i].type == ChannelType::kIds) {
      AddRanks(channels[i], i, picture);
    } else {
      picture.push_back(ValueChannel(channels[i], i));
    }
  }
  return picture;
}

ChannelLayout::ChannelLayout(const std::vector<Channel>& channels, bool keeps_counts)
    : slots_(channels.size()) {
  for (const Channel& channel : channels) names_.push_back(channel.name);
  Place(channels, MergeRule::kSum, keeps_counts);
  const auto depth = std::ranges::find(channels, ChannelType::kDepth, &Channel::type);
  if (depth != channels.end()) {
    slots_[static_cast<size_t>(depth - channels.begin())] = shape_.sums;
    ++shape_.nearest;
  }
  Place(channels, MergeRule::kNearest, keeps_counts);
  Place(channels, MergeRule::kIdWeights, keeps_counts);
}

// Gives the channels of a rule that have no position yet the next ones.
void ChannelLayout::Place(const std::vector<Channel>& channels, MergeRule rule, bool keeps_counts) {
  uint32_t& size = rule == MergeRule::kSum       ? shape_.sums
                   : rule == MergeRule::kNearest ? shape_.nearest
                                                 : shape_.id_sets;
  for (size_t i = 0; i < channels.size(); ++i) {
    const Channel& channel = channels[i];
    const bool is_count = channel.type == ChannelType::kCount;
    if (channel.rule != rule || slots_[i] || (is_count && !keeps_counts)) continue;
    const size_t slot = shape_.stride();
    slots_[i] = slot;
    ++size;
    if (channel.type == ChannelType::kWeight) weight_ = slot;
    if (is_count) samples_ = slot;
    if (rule == MergeRule::kSum && IsColorChannel(channel.name)) colors_.push_back(slot);
  }
}

std::optional<size_t> ChannelLayout::SlotOf(const std::string& name) const {
  const auto found = std::ranges::find(names_, name);
  if (found == names_.end()) return std::nullopt;
  return slots_[static_cast<size_t>(found - names_.begin())];
}

}  // namespace tessera
