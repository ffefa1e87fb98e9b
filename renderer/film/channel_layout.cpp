#include "renderer/film/channel_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace tessera {
namespace {

using Source = PictureChannel::Source;

// What follows the last dot of a name, and what precedes it.
std::string ComponentOf(const std::string& name) {
  return name.substr(name.rfind('.') + 1);
}
std::string LayerOf(const std::string& name) {
  return name.substr(0, name.rfind('.'));
}

// How channels of a type are written with the help of others: channels of a certain type, and of a certain
// name unless that is empty.
struct Operand {
  ChannelType type;
  std::string name;
};

std::vector<Operand> OperandsOf(const Channel& channel) {
  switch (channel.type) {
    case ChannelType::kVariance: return {{ChannelType::kColor, ComponentOf(channel.name)}};
    case ChannelType::kHitFloat:
    case ChannelType::kHitSlope: return {{ChannelType::kHitWeight, ""}};
    case ChannelType::kDirection: {
      const std::string layer = LayerOf(channel.name);
      return {{ChannelType::kDirection, layer + ".X"},
              {ChannelType::kDirection, layer + ".Y"},
              {ChannelType::kDirection, layer + ".Z"}};
    }
    case ChannelType::kHitSquare:
      return {{ChannelType::kHitSum, channel.name + ".sum"}, {ChannelType::kHitCount, ""}};
    case ChannelType::kColor:
    case ChannelType::kWeight:
    case ChannelType::kCount:
    case ChannelType::kFloat:
    case ChannelType::kDepth:
    case ChannelType::kIds:
    case ChannelType::kHitWeight:
    case ChannelType::kHitCount:
    case ChannelType::kHitSum: break;
  }
  return {};
}

std::optional<size_t> Find(const std::vector<Channel>& channels, const Operand& operand) {
  const auto found = std::ranges::find_if(channels, [&](const Channel& channel) {
    return channel.type == operand.type && channel.rule == MergeRule::kSum &&
           (operand.name.empty() || channel.name == operand.name);
  });
  if (found == channels.end()) return std::nullopt;
  return static_cast<size_t>(found - channels.begin());
}

Source SourceOf(const Channel& channel) {
  switch (channel.type) {
    case ChannelType::kDepth: return Source::kDepth;
    case ChannelType::kCount: return Source::kSamples;
    case ChannelType::kVariance: return Source::kVariance;
    case ChannelType::kHitFloat: return Source::kHitMean;
    case ChannelType::kHitSlope: return Source::kHitSlope;
    case ChannelType::kDirection: return Source::kDirection;
    case ChannelType::kHitSquare: return Source::kHitVariance;
    case ChannelType::kColor:
    case ChannelType::kWeight:
    case ChannelType::kFloat:
    case ChannelType::kIds:
    case ChannelType::kHitWeight:
    case ChannelType::kHitCount:
    case ChannelType::kHitSum: break;
  }
  return channel.rule == MergeRule::kSum ? Source::kMean : Source::kValue;
}

void AddValue(const std::vector<Channel>& channels, size_t index, std::vector<PictureChannel>& picture) {
  const Channel& channel = channels[index];
  PictureChannel value{channel.name, SourceOf(channel), index, 0, channel.type != ChannelType::kColor, {}};
  size_t i = 0;
  for (const Operand& operand : OperandsOf(channel))
    value.operands[i++] = Find(channels, operand).value_or(index);
  picture.push_back(value);
  if (channel.type != ChannelType::kHitSquare) return;
  value.name = "Relative" + channel.name;
  value.source = Source::kRelativeHitVariance;
  picture.push_back(std::move(value));
}

// Each rank is an id and its coverage.
void AddRanks(const Channel& channel, size_t index, uint32_t levels, std::vector<PictureChannel>& picture) {
  constexpr std::array<const char*, 2 * kRanksPerCryptomatteLevel> kComponents{"R", "G", "B", "A"};
  for (uint32_t i = 0; i < kComponents.size() * levels; ++i) {
    const Source source = i % 2 == 0 ? Source::kRankedId : Source::kRankedCoverage;
    const auto* const component = kComponents[i % kComponents.size()];
    picture.push_back({fmt::format("{}{:02}.{}", channel.name, i / kComponents.size(), component),
                       source,
                       index,
                       i / 2,
                       true,
                       {}});
  }
}

}  // namespace

std::vector<PictureChannel> PictureChannels(const std::vector<Channel>& channels,
                                            uint32_t cryptomatte_levels) {
  std::vector<PictureChannel> picture;
  for (size_t i = 0; i < channels.size(); ++i) {
    if (!channels[i].is_written) continue;
    if (channels[i].type == ChannelType::kIds) {
      AddRanks(channels[i], i, cryptomatte_levels, picture);
    } else {
      AddValue(channels, i, picture);
    }
  }
  return picture;
}

std::string MissingOperand(const std::vector<Channel>& channels, const Channel& channel) {
  for (const Operand& operand : OperandsOf(channel)) {
    if (Find(channels, operand)) continue;
    return operand.name.empty() ? "of the samples that hit a surface" : fmt::format("\"{}\"", operand.name);
  }
  return {};
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
