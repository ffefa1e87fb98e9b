#include "renderer/scene/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderer/scene/screen_motion.h"

namespace tessera {
namespace {

// ---- What fills layers

void Put(Vec3 v, float* values) {
  values[0] = v.x;
  values[1] = v.y;
  values[2] = v.z;
}

// Of the first surface, if the sample sees one.
template <void (*kFill)(const SeenSurface& seen, const LayerSample& sample, float* values)>
void OfSurface(const LayerSample& sample, float* values) {
  if (sample.parts.surface) kFill(*sample.parts.surface, sample, values);
}

void FillAlbedo(const SeenSurface& seen, const LayerSample& sample, float* values) {
  Put(sample.scene.sensor.ReflectanceToRgb(seen.albedo, sample.first_wavelengths), values);
}
void FillNormal(const SeenSurface& seen, const LayerSample&, float* values) {
  Put(FaceForward(seen.interaction.shading.n, seen.interaction.wo), values);
}
// What denoisers are guided by: of what is mirrored, or of the first surface if nothing is.
void FillDenoisingAlbedo(const SeenSurface& seen, const LayerSample& sample, float* values) {
  const auto& mirrored = sample.parts.mirrored;
  if (!mirrored) return FillAlbedo(seen, sample, values);
  Put(sample.scene.sensor.ReflectanceToRgb(mirrored->albedo, sample.first_wavelengths), values);
}
void FillDenoisingNormal(const SeenSurface& seen, const LayerSample& sample, float* values) {
  const auto& mirrored = sample.parts.mirrored;
  if (!mirrored) return FillNormal(seen, sample, values);
  Put(mirrored->n, values);
}
void FillGeometricNormal(const SeenSurface& seen, const LayerSample&, float* values) {
  Put(FaceForward(seen.interaction.n, seen.interaction.wo), values);
}
// A depth of 0 would stand for nothing.
void FillDepth(const SeenSurface& seen, const LayerSample&, float* values) {
  values[0] = std::max(seen.distance, std::numeric_limits<float>::min());
}
void FillPosition(const SeenSurface& seen, const LayerSample& sample, float* values) {
  Put(sample.scene.world.camera.render_from_world().Inverse().ToPoint(seen.interaction.p), values);
}
void FillUv(const SeenSurface& seen, const LayerSample&, float* values) {
  values[0] = seen.interaction.uv.x;
  values[1] = seen.interaction.uv.y;
}
// Samples that see the sky keep its motion as long as none sees a surface: of those the first.
void FillMotion(const LayerSample& sample, float* values) {
  const World& world = sample.scene.world;
  const TimeRange& times = sample.scene.motion_times;
  Vec2 motion{0, 0};
  if (const auto& seen = sample.parts.surface) {
    motion = ScreenMotion(world, seen->hit, seen->interaction, sample.film, times);
  } else if (AnyNonZero(sample.parts.transmittance)) {
    motion = ScreenMotionOfSky(world.camera, sample.film, sample.time_s, times);
  }
  values[0] = motion.x;
  values[1] = motion.y;
}

template <MatteKind kKind>
void FillMatte(const SeenSurface& seen, const LayerSample& sample, float* values) {
  values[0] = sample.scene.mattes.IdOf(kKind, seen.hit);
}

void FillAlpha(const LayerSample& sample, float* values) {
  values[0] = 1 - std::clamp(Average(sample.parts.transmittance), 0.0f, 1.0f);
}
void FillVariance(const LayerSample& sample, float* values) {
  Put(Rgb{sample.rgb.x * sample.rgb.x, sample.rgb.y * sample.rgb.y, sample.rgb.z * sample.rgb.z}, values);
}
// Every fourth of the samples counts with the other sign: as many as with the first one among eight in order.
void FillHalves(const LayerSample& sample, float* values) {
  const float sign = (sample.index >> 2 & 1) == 0 ? 1.0f : -1.0f;
  Put(Rgb{sample.rgb.x * sign, sample.rgb.y * sign, sample.rgb.z * sign}, values);
}

void FillColor(const LayerSample& sample, SampledSpectrum part, float* values) {
  if (AnyNonZero(part)) Put(sample.ColorOf(part), values);
}
template <SampledSpectrum SampleParts::*kPart>
void FillPart(const LayerSample& sample, float* values) {
  FillColor(sample, sample.parts.*kPart, values);
}
template <ScatteredLight SampleParts::*kLight>
void FillLight(const LayerSample& sample, float* values) {
  FillColor(sample, (sample.parts.*kLight).all, values);
}
template <ScatteredLight SampleParts::*kLight, Lobe kLobe>
void FillLobe(const LayerSample& sample, float* values) {
  FillColor(sample, (sample.parts.*kLight).lobes[kLobe], values);
}

// ---- The table

constexpr RecordNeeds kNothing{};
constexpr RecordNeeds kSurface{.surface = true};
constexpr RecordNeeds kAlbedo{.surface = true, .albedo = true};
constexpr RecordNeeds kMirroredNormal{.surface = true, .mirrored = true};
constexpr RecordNeeds kMirroredAlbedo{.surface = true, .albedo = true, .mirrored = true};
constexpr RecordNeeds kLobes{.lobes = true};
constexpr RecordNeeds kShadow{.shadow = true};

// Light, as colours with the precision of the picture's own.
constexpr Layer Light(void (*fill)(const LayerSample&, float*), const RecordNeeds& needs = kNothing) {
  return {"RGB", ChannelType::kColor, MergeRule::kSum, needs, fill};
}
// The mean of values over all samples: 0 counts for those that see no surface.
constexpr Layer Mean(std::string_view components, const RecordNeeds& needs,
                     void (*fill)(const LayerSample&, float*)) {
  return {components, ChannelType::kFloat, MergeRule::kSum, needs, fill};
}
// The values of the sample that sees the nearest surface.
constexpr Layer Nearest(std::string_view components, void (*fill)(const LayerSample&, float*),
                        ChannelType type = ChannelType::kFloat) {
  return {components, type, MergeRule::kNearest, kSurface, fill};
}

// The ids of what the samples see.
template <MatteKind kKind>
constexpr Layer Matte() {
  return {"1",      ChannelType::kIds,           MergeRule::kIdWeights,
          kSurface, OfSurface<FillMatte<kKind>>, MatteLayer(kKind)};
}

constexpr auto kDirect = &SampleParts::direct;
constexpr auto kIndirect = &SampleParts::indirect;
constexpr std::string_view kDepthLayer = "depth";
// By MatteKind.
constexpr MatteKind kMatteKinds[] = {MatteKind::kObject, MatteKind::kMaterial, MatteKind::kAsset};
constexpr std::string_view kMatteLayers[] = {"crypto_object", "crypto_material", "crypto_asset"};
constexpr std::string_view kMotionLayer = "motion";

// In the order in which frames have the channels.
constexpr Kind<Layer> kLayers[] = {
    {kSamplesChannel,
     Support::kSupported,
     {"N", ChannelType::kCount, MergeRule::kSum, kNothing, nullptr, kSamplesChannel}},
    {"albedo", Support::kSupported, Mean("RGB", kAlbedo, OfSurface<FillAlbedo>)},
    {"normal", Support::kSupported, Mean("XYZ", kSurface, OfSurface<FillNormal>)},
    {kDepthLayer, Support::kSupported, Nearest("Z", OfSurface<FillDepth>, ChannelType::kDepth)},
    {kMatteLayers[0], Support::kSupported, Matte<MatteKind::kObject>()},
    {kMatteLayers[1], Support::kSupported, Matte<MatteKind::kMaterial>()},
    {kMatteLayers[2], Support::kSupported, Matte<MatteKind::kAsset>()},
    {"alpha", Support::kSupported, {"A", ChannelType::kColor, MergeRule::kSum, kNothing, FillAlpha, "A"}},
    {"position", Support::kSupported, Nearest("XYZ", OfSurface<FillPosition>)},
    {"normal_geometric", Support::kSupported, Mean("XYZ", kSurface, OfSurface<FillGeometricNormal>)},
    {"uv", Support::kSupported, Nearest("UV", OfSurface<FillUv>)},
    {kMotionLayer, Support::kSupported, Nearest("XY", FillMotion)},
    {"emission", Support::kSupported, Light(FillPart<&SampleParts::emission>)},
    {"direct", Support::kSupported, Light(FillLight<kDirect>)},
    {"direct_diffuse", Support::kSupported, Light(FillLobe<kDirect, kDiffuseLobe>, kLobes)},
    {"direct_specular", Support::kSupported, Light(FillLobe<kDirect, kSpecularLobe>, kLobes)},
    {"direct_transmission", Support::kSupported, Light(FillLobe<kDirect, kTransmissionLobe>, kLobes)},
    {"direct_volume", Support::kSupported, Light(FillLobe<kDirect, kVolumeLobe>, kLobes)},
    {"indirect", Support::kSupported, Light(FillLight<kIndirect>)},
    {"indirect_diffuse", Support::kSupported, Light(FillLobe<kIndirect, kDiffuseLobe>, kLobes)},
    {"indirect_specular", Support::kSupported, Light(FillLobe<kIndirect, kSpecularLobe>, kLobes)},
    {"indirect_transmission", Support::kSupported, Light(FillLobe<kIndirect, kTransmissionLobe>, kLobes)},
    {"indirect_volume", Support::kSupported, Light(FillLobe<kIndirect, kVolumeLobe>, kLobes)},
    {"shadow", Support::kSupported, Light(FillPart<&SampleParts::shadow>, kShadow)},
    {"variance",
     Support::kSupported,
     {"RGB", ChannelType::kVariance, MergeRule::kSum, kNothing, FillVariance}},
    {kLightGroupsLayer, Support::kSupported, {}},
    {"halves", Support::kSupported, Mean("RGB", kNothing, FillHalves)},
    {"denoising_albedo", Support::kSupported, Mean("RGB", kMirroredAlbedo, OfSurface<FillDenoisingAlbedo>)},
    {"denoising_normal", Support::kSupported, Mean("XYZ", kMirroredNormal, OfSurface<FillDenoisingNormal>)},
};
constexpr KindTable<Layer> kLayerTable("layer", kLayers);

}  // namespace

KindTable<Layer> Layers() {
  return kLayerTable;
}

std::vector<Channel> ChannelsOf(const Kind<Layer>& layer) {
  const auto& [components, type, rule, needs, fill, channel_name] = layer.reader;
  const bool is_written = !IsNeverWritten(type);
  if (!channel_name.empty()) return {{std::string(channel_name), type, rule, is_written}};
  std::vector<Channel> channels;
  for (const char component : components)
    channels.push_back({fmt::format("{}.{}", layer.name, component), type, rule, is_written});
  return channels;
}

const std::vector<LayerSet>& LayerSets() {
  static const std::vector<LayerSet> sets{
      {"all", kLayerTable.Names()},
      {"denoise",
       {"albedo", "normal", kDepthLayer, kMotionLayer, "variance", "halves", "denoising_albedo",
        "denoising_normal"}},
  };
  return sets;
}

std::set<std::string> ExpandLayers(const std::set<std::string>& names, bool moves, bool has_light_groups) {
  const auto has = [&](std::string_view layer) {
    return layer == kMotionLayer ? moves : layer != kLightGroupsLayer || has_light_groups;
  };
  std::set<std::string> layers = names;
  for (const LayerSet& set : LayerSets()) {
    if (layers.erase(std::string(set.name)) == 0) continue;
    for (const std::string_view layer : set.layers) {
      if (has(layer)) layers.emplace(layer);
    }
  }
  return layers;
}

void AddLayers(const std::set<std::string>& layers, std::vector<Channel>& channels) {
  for (const Kind<Layer>& kind : kLayers) {
    if (!layers.contains(std::string(kind.name))) continue;
    for (const Channel& channel : ChannelsOf(kind)) AddChannel(channels, channel);
  }
  if (std::ranges::find(channels, MergeRule::kNearest, &Channel::rule) == channels.end()) return;
  for (Channel& depth : ChannelsOf(*kLayerTable.Find(kDepthLayer))) {
    depth.is_written = false;
    AddChannel(channels, depth);
  }
}

bool HasMattes(const std::set<std::string>& layers) {
  return std::ranges::any_of(kMatteLayers,
                             [&](std::string_view layer) { return layers.contains(std::string(layer)); });
}

void AddMatteNames(const std::set<std::string>& layers, const MatteTable& mattes, const std::string& place,
                   Diagnostics& diagnostics, std::map<std::string, std::string>& attributes) {
  for (const MatteKind kind : kMatteKinds) {
    if (layers.contains(std::string(kMatteLayers[static_cast<size_t>(kind)])))
      mattes.AddAttributes(kind, place, diagnostics, attributes);
  }
}

std::vector<std::string_view> AovNames() {
  std::vector<std::string_view> names = Layers().Names();
  for (const LayerSet& set : LayerSets()) names.push_back(set.name);
  return names;
}

}  // namespace tessera
