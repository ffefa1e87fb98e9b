#include "renderer/film/channel.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "renderer/film/channel_layout.h"

namespace tessera {
namespace {

constexpr size_t kNameBytesMax = 255;  // what OpenEXR can write

bool Fit(ChannelType type, MergeRule rule) {
  switch (type) {
    case ChannelType::kColor:
    case ChannelType::kFloat: return rule == MergeRule::kSum || rule == MergeRule::kNearest;
    case ChannelType::kWeight:
    case ChannelType::kCount:
    case ChannelType::kVariance:
    case ChannelType::kHitWeight:
    case ChannelType::kHitFloat:
    case ChannelType::kHitSlope:
    case ChannelType::kDirection:
    case ChannelType::kHitCount:
    case ChannelType::kHitSum:
    case ChannelType::kHitSquare: return rule == MergeRule::kSum;
    case ChannelType::kDepth: return rule == MergeRule::kNearest;
    case ChannelType::kIds: return rule == MergeRule::kIdWeights;
  }
  return false;
}

Result<void> CheckChannel(const Channel& channel) {
  if (channel.name.empty() || channel.name.find('\0') != std::string::npos)
    return BadInput("a channel's name is empty or holds a zero byte");
  if (channel.name.size() > kNameBytesMax)
    return BadInput(fmt::format("a channel's name has {} bytes; at most {} are allowed", channel.name.size(),
                                kNameBytesMax));
  if (!Fit(channel.type, channel.rule))
    return BadInput(
        fmt::format("channel \"{}\": its type and its merge rule do not go together", channel.name));
  if (IsNeverWritten(channel.type) && channel.is_written)
    return BadInput(
        fmt::format("channel \"{}\": {} are never written", channel.name,
                    channel.type == ChannelType::kHitSum ? "sums over hits" : "weights and counts"));
  if ((channel.type == ChannelType::kCount) != (channel.name == kSamplesChannel)) {
    return BadInput(fmt::format("channel \"{}\": the count of samples, and nothing else, is called \"{}\"",
                                channel.name, kSamplesChannel));
  }
  return {};
}

// Every channel that is written with the help of others has them.
Result<void> CheckOperands(const std::vector<Channel>& channels) {
  for (const Channel& channel : channels) {
    if (const std::string missing = MissingOperand(channels, channel); !missing.empty())
      return BadInput(fmt::format("channel \"{}\" needs a channel {}", channel.name, missing));
  }
  return {};
}

Result<void> CheckNamesDiffer(const std::vector<Channel>& channels, uint32_t cryptomatte_levels) {
  std::set<std::string> names;
  for (const Channel& channel : channels) names.insert(channel.name);
  if (names.size() != channels.size()) return BadInput("a channel's name appears twice in the frame");
  std::set<std::string> written;
  for (const PictureChannel& channel : PictureChannels(channels, cryptomatte_levels)) {
    if (channel.name.size() > kNameBytesMax || !written.insert(channel.name).second) {
      return BadInput(
          fmt::format("channel \"{}\" of the picture is there twice, or its name too long", channel.name));
    }
  }
  return {};
}

}  // namespace

std::vector<Channel> ColorsAndWeight(const std::vector<std::string>& names) {
  std::vector<Channel> channels;
  channels.reserve(names.size() + 1);
  for (const std::string& name : names) channels.push_back({name});
  channels.push_back({"W", ChannelType::kWeight, MergeRule::kSum, false});
  return channels;
}

Channel SamplesChannel(bool is_written) {
  return {kSamplesChannel, ChannelType::kCount, MergeRule::kSum, is_written};
}

std::vector<Channel> ChannelsFromNames(const std::vector<std::string>& names, bool writes_samples) {
  std::vector<Channel> channels;
  for (const std::string& name : names) {
    if (name == "W") {
      channels.push_back({name, ChannelType::kWeight, MergeRule::kSum, false});
    } else if (name == kSamplesChannel) {
      channels.push_back(SamplesChannel(false));
    } else {
      channels.push_back({name});
    }
  }
  if (writes_samples) AddChannel(channels, SamplesChannel(true));
  return channels;
}

void AddChannel(std::vector<Channel>& channels, Channel added) {
  const auto same = std::ranges::find(channels, added.name, &Channel::name);
  if (same != channels.end() && !(same->is_written && added.is_written)) {
    if (added.is_written) *same = std::move(added);
    return;
  }
  channels.insert(std::ranges::find(channels, ChannelType::kWeight, &Channel::type), std::move(added));
}

bool IsNeverWritten(ChannelType type) {
  return type == ChannelType::kWeight || type == ChannelType::kHitWeight || type == ChannelType::kHitCount ||
         type == ChannelType::kHitSum;
}

bool IsColorChannel(const std::string& name) {
  return name == "R" || name == "G" || name == "B";
}

Result<void> CheckChannels(const std::vector<Channel>& channels, uint32_t cryptomatte_levels) {
  if (channels.size() < 2 || channels.size() > kChannelsMax)
    return BadInput(fmt::format(
        "a frame has 2 to {} channels, not {}: ask for fewer layers (--aov), light groups or spectral "
        "buckets",
        kChannelsMax, channels.size()));
  for (const Channel& channel : channels) {
    if (auto ok = CheckChannel(channel); !ok) return ok;
  }
  const auto count = [&](ChannelType type) { return std::ranges::count(channels, type, &Channel::type); };
  if (count(ChannelType::kWeight) != 1) return BadInput("a frame has one channel of the filter weight");
  const bool has_nearest = std::ranges::count(channels, MergeRule::kNearest, &Channel::rule) > 0;
  if (count(ChannelType::kDepth) != (has_nearest ? 1 : 0))
    return BadInput("channels of the nearest sample need one channel of its depth");
  if (count(ChannelType::kHitWeight) > 1 || count(ChannelType::kHitCount) > 1)
    return BadInput("a frame has at most one weight and one count of the samples that hit a surface");
  if (std::ranges::none_of(channels, &Channel::is_written))
    return BadInput("no channel of the frame is written");
  if (auto ok = CheckOperands(channels); !ok) return ok;
  return CheckNamesDiffer(channels, cryptomatte_levels);
}

}  // namespace tessera
