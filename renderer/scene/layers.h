// The layers that a picture may have beside its colours (--aov). Each is a row of the table in layers.cpp:
// its channels, what of a sample it looks at, and how that fills them. Nothing else knows single layers.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/kind_table.h"
#include "renderer/film/channel.h"
#include "renderer/scene/layer_sample.h"
#include "renderer/scene/mattes.h"

namespace tessera {

struct Layer {
  // One letter a channel: those of layer "uv" with the components "UV" are "uv.U" and "uv.V".
  std::string_view components;
  ChannelType type = ChannelType::kFloat;
  MergeRule rule = MergeRule::kSum;
  RecordNeeds needs;
  // Writes one value per channel, which are 0, or none; of a channel of ids the id that the sample sees. Null
  // if the film fills the layer by itself.
  void (*fill)(const LayerSample& sample, float* values) = nullptr;
  // If not empty: the name of the layer's only channel.
  std::string_view channel_name = {};
};

KindTable<Layer> Layers();
std::vector<Channel> ChannelsOf(const Kind<Layer>& layer);

// The names that stand for several layers, and the layers of one of them.
struct LayerSet {
  std::string_view name;
  std::vector<std::string_view> layers;
};
const std::vector<LayerSet>& LayerSets();

// The layer of LightGroups, which has its channels.
constexpr std::string_view kLightGroupsLayer = "light_groups";

// The layers that these names of layers and sets stand for. A set has "motion" only if something moves, and
// kLightGroupsLayer only if any light has a group.
std::set<std::string> ExpandLayers(const std::set<std::string>& names, bool moves, bool has_light_groups);

// Adds the channels of these layers, and the depth, which is not written unless it is one of them, if any
// channel is that of the nearest sample.
void AddLayers(const std::set<std::string>& layers, std::vector<Channel>& channels);

// Whether a picture with these layers has mattes, so that what the scene holds must be named.
bool HasMattes(const std::set<std::string>& layers);
// What the header of such a picture says of them.
void AddMatteNames(const std::set<std::string>& layers, const MatteTable& mattes, const std::string& place,
                   Diagnostics& diagnostics, std::map<std::string, std::string>& attributes);

}  // namespace tessera
