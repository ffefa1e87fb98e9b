#include "renderer/scene/layers.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "renderer/scene/layer_names.h"
#include "renderer/scene/scene.h"

namespace tessera {
namespace {

constexpr size_t kLayerChannelsMax = 4;

Channel Value(const char* name) {
  return {name, ChannelType::kFloat, MergeRule::kSum};
}

constexpr MatteKind kMatteKinds[] = {MatteKind::kObject, MatteKind::kMaterial, MatteKind::kAsset};

// Its name in the table.
std::string_view LayerOf(MatteKind kind) {
  return kLayerNames[4 + static_cast<size_t>(kind)];
}

// A row of the table for a matte of Cryptomatte, whose values are ids.
template <MatteKind kKind>
constexpr Layer MatteRow() {
  return {[] {
            return std::vector<Channel>{{MatteLayer(kKind), ChannelType::kIds, MergeRule::kIdWeights}};
          },
          [](const LayerSample& sample, float* values) {
            values[0] = sample.mattes.IdOf(kKind, sample.first.hit);
          }};
}

constexpr Kind<Layer> kLayers[] = {
    // The number of samples of each pixel.
    {kLayerNames[0],
     Support::kSupported,
     {[] { return std::vector<Channel>{SamplesChannel(true)}; }, nullptr}},
    // For denoisers: the mean reflectance, as colours under the white of the picture.
    {kLayerNames[1],
     Support::kSupported,
     {[] {
        return std::vector<Channel>{Value("albedo.R"), Value("albedo.G"), Value("albedo.B")};
      },
      [](const LayerSample& sample, float* values) {
        const Rgb rgb = sample.sensor.ReflectanceToRgb(sample.first.albedo, sample.wavelengths);
        values[0] = rgb.x;
        values[1] = rgb.y;
        values[2] = rgb.z;
      }}},
    // For denoisers: the mean shading normal, in world space and towards the camera.
    {kLayerNames[2],
     Support::kSupported,
     {[] {
        return std::vector<Channel>{Value("N.X"), Value("N.Y"), Value("N.Z")};
      },
      [](const LayerSample& sample, float* values) {
        const SurfaceInteraction& surface = sample.first.surface;
        const Normal3 n = FaceForward(surface.shading.n, surface.wo);
        values[0] = n.x;
        values[1] = n.y;
        values[2] = n.z;
      }}},
    // For compositing: the least distance from the camera.
    {kLayerNames[3],
     Support::kSupported,
     {[] {
        return std::vector<Channel>{{"Z", ChannelType::kDepth, MergeRule::kNearest}};
      },
      [](const LayerSample& sample, float* values) { values[0] = sample.first.distance; }}},
    // For compositing: which share of the pixel each object, material and asset covers.
    {kLayerNames[4], Support::kSupported, MatteRow<MatteKind::kObject>()},
    {kLayerNames[5], Support::kSupported, MatteRow<MatteKind::kMaterial>()},
    {kLayerNames[6], Support::kSupported, MatteRow<MatteKind::kAsset>()},
};
static_assert(std::size(kLayers) == std::size(kLayerNames));

}  // namespace

KindTable<Layer> Layers() {
  return {"layer", kLayers};
}

void AddLayers(const std::set<std::string>& names, std::vector<Channel>& channels) {
  for (const Kind<Layer>& kind : kLayers) {
    if (!names.contains(std::string(kind.name))) continue;
    for (const Channel& channel : kind.reader.channels()) AddChannel(channels, channel);
  }
}

void AddMatteNames(const std::set<std::string>& names, const MatteTable& mattes, const std::string& place,
                   Diagnostics& diagnostics, std::map<std::string, std::string>& attributes) {
  for (const MatteKind kind : kMatteKinds) {
    if (names.contains(std::string(LayerOf(kind))))
      mattes.AddAttributes(kind, place, diagnostics, attributes);
  }
}

bool HasMattes(const std::set<std::string>& names) {
  return std::ranges::any_of(kMatteKinds,
                             [&](MatteKind kind) { return names.contains(std::string(LayerOf(kind))); });
}

LayerRecorder::LayerRecorder(const std::set<std::string>& names, const ChannelLayout& layout,
                             const FilmSensor& sensor, const MatteTable& mattes)
    : sensor_(sensor), mattes_(mattes) {
  const size_t first_set = size_t{layout.shape().sums} + layout.shape().nearest;
  for (const Kind<Layer>& kind : kLayers) {
    if (kind.reader.fill == nullptr || !names.contains(std::string(kind.name))) continue;
    Output output{&kind.reader, {}};
    for (const Channel& channel : kind.reader.channels()) {
      const size_t slot = *layout.SlotOf(channel.name);
      const bool is_id = channel.rule == MergeRule::kIdWeights;
      output.targets.push_back({is_id ? slot - first_set : slot, channel.rule});
    }
    TESSERA_CHECK(output.targets.size() <= kLayerChannelsMax);
    outputs_.push_back(std::move(output));
  }
}

void LayerRecorder::Start(const SampledWavelengths& wavelengths, float filter_weight, TileBuilder& tile) {
  wavelengths_ = wavelengths;
  filter_weight_ = filter_weight;
  tile_ = &tile;
}

void LayerRecorder::AddFirstHit(const FirstHit& first) {
  for (const Output& output : outputs_) {
    float layer[kLayerChannelsMax] = {};
    output.layer->fill({first, wavelengths_, sensor_, mattes_}, layer);
    for (size_t i = 0; i < output.targets.size(); ++i) {
      // A tile must not hold NaN or infinite values, which degenerate geometry can give.
      if (!std::isfinite(layer[i])) continue;
      const Target& target = output.targets[i];
      switch (target.rule) {
        case MergeRule::kSum: tile_->Values()[target.slot] = layer[i] * filter_weight_; break;
        case MergeRule::kNearest: tile_->Values()[target.slot] = layer[i]; break;
        case MergeRule::kIdWeights: tile_->AddId(target.slot, layer[i], filter_weight_); break;
      }
    }
  }
}

}  // namespace tessera
