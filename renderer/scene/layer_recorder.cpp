#include "renderer/scene/layer_recorder.h"

#include <algorithm>
#include <cmath>

#include "renderer/scene/gbuffer.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr size_t kComponentsMax = 4;

// What the values of a channel are multiplied by.
float FactorOf(const Layer& layer, float filter_weight) {
  if (layer.rule == MergeRule::kNearest) return 1;
  switch (layer.type) {
    case ChannelType::kVariance: return filter_weight * filter_weight;
    case ChannelType::kHitCount:
    case ChannelType::kHitSum:
    case ChannelType::kHitSquare: return 1;
    case ChannelType::kColor:
    case ChannelType::kWeight:
    case ChannelType::kCount:
    case ChannelType::kFloat:
    case ChannelType::kDepth:
    case ChannelType::kIds:
    case ChannelType::kHitWeight:
    case ChannelType::kHitFloat:
    case ChannelType::kHitSlope:
    case ChannelType::kDirection: break;
  }
  return filter_weight;
}

void AddScattered(SampledSpectrum contribution, const FirstVertex& first, ScatteredLight& light) {
  light.all += contribution;
  switch (first.scatter) {
    case FirstScatter::kNone: return;
    case FirstScatter::kTransmission: light.lobes[kTransmissionLobe] += contribution; return;
    case FirstScatter::kMedium: light.lobes[kVolumeLobe] += contribution; return;
    case FirstScatter::kReflection: break;
  }
  const SampledSpectrum diffuse = contribution * first.diffuse;
  light.lobes[kDiffuseLobe] += diffuse;
  light.lobes[kSpecularLobe] += contribution - diffuse;
}

}  // namespace

LayerRecorder::LayerRecorder(const LayerScene& scene, const ChannelLayout& layout)
    : SampleRecorder(RecordNeeds{}), scene_(scene) {
  AddGroups(layout);
  for (const Kind<Layer>& kind : Layers().kinds()) AddOutput(kind, layout);
  if (scene.gbuffer == GbufferSpace::kNone) return;
  for (const Kind<Layer>& kind : GbufferLayers()) AddOutput(kind, layout);
}

void LayerRecorder::AddOutput(const Kind<Layer>& kind, const ChannelLayout& layout) {
  if (kind.reader.fill == nullptr) return;
  Output output{&kind.reader, {}};
  const size_t first_set = size_t{layout.shape().sums} + layout.shape().nearest;
  const bool are_ids = kind.reader.rule == MergeRule::kIdWeights;
  for (const Channel& channel : ChannelsOf(kind)) {
    if (const auto slot = layout.SlotOf(channel.name))
      output.slots.push_back(are_ids ? *slot - first_set : *slot);
  }
  if (output.slots.empty()) return;
  TESSERA_CHECK(output.slots.size() == kind.reader.components.size());
  TESSERA_CHECK(output.slots.size() <= kComponentsMax);
  needs_ = needs_ | kind.reader.needs;
  outputs_.push_back(std::move(output));
}

void LayerRecorder::AddGroups(const ChannelLayout& layout) {
  for (const std::string& group : scene_.groups.names()) {
    const auto slot = [&](char component) {
      return layout.SlotOf(LightGroups::ChannelName(group, component));
    };
    if (!slot('R')) return;
    group_slots_.push_back({*slot('R'), *slot('G'), *slot('B')});
  }
  parts_.groups.resize(group_slots_.size());
}

void LayerRecorder::Start(const SampledWavelengths& wavelengths) {
  first_wavelengths_ = wavelengths;
  std::vector<SampledSpectrum> groups = std::move(parts_.groups);
  std::ranges::fill(groups, SampledSpectrum(0.0f));
  parts_ = SampleParts();
  parts_.groups = std::move(groups);
}

void LayerRecorder::Add(SampledSpectrum contribution, const LightPath& path) {
  if (!group_slots_.empty()) parts_.groups[scene_.groups.GroupOf(path.light)] += contribution;
  switch (path.depth) {
    case 0: parts_.emission += contribution; break;
    case 1: AddScattered(contribution, path.first, parts_.direct); break;
    default: AddScattered(contribution, path.first, parts_.indirect); break;
  }
}

void LayerRecorder::AddFirstHit(const FirstHit& first) {
  parts_.surface = SeenSurface{first.hit, first.surface, first.distance, first.albedo};
}

void LayerRecorder::WriteGroups(const LayerSample& sample, float filter_weight, float* values) const {
  for (size_t i = 0; i < group_slots_.size(); ++i) {
    if (!AnyNonZero(sample.parts.groups[i])) continue;
    const Rgb rgb = sample.ColorOf(sample.parts.groups[i]);
    for (size_t c = 0; c < 3; ++c) {
      if (std::isfinite(rgb[static_cast<int>(c)]))
        values[group_slots_[i][c]] = rgb[static_cast<int>(c)] * filter_weight;
    }
  }
}

void LayerRecorder::Finish(const End& end, TileBuilder& tile) {
  if (!end.rgb) {
    parts_.emission = parts_.shadow = SampledSpectrum(0.0f);
    parts_.direct = parts_.indirect = ScatteredLight();
    std::ranges::fill(parts_.groups, SampledSpectrum(0.0f));
  }
  const LayerSample sample{scene_,    parts_,   first_wavelengths_, end.exposure, end.rgb.value_or(Rgb{}),
                           end.index, end.film, end.time_s};
  float* const values = tile.Values();
  WriteGroups(sample, end.filter_weight, values);
  for (const Output& output : outputs_) {
    float layer[kComponentsMax] = {};
    output.layer->fill(sample, layer);
    if (output.layer->rule == MergeRule::kIdWeights) {
      if (layer[0] != 0) tile.AddId(output.slots[0], layer[0], end.filter_weight);
      continue;
    }
    const float factor = FactorOf(*output.layer, end.filter_weight);
    for (size_t i = 0; i < output.slots.size(); ++i) {
      // A tile must not hold NaN or infinite values, which degenerate geometry can give.
      if (std::isfinite(layer[i])) values[output.slots[i]] = layer[i] * factor;
    }
  }
}

}  // namespace tessera
