#include "renderer/scene/layers.h"

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

LayerRecorder::LayerRecorder(const std::set<std::string>& names, const ChannelLayout& layout,
                             const FilmSensor& sensor)
    : sensor_(sensor) {
  for (const Kind<Layer>& kind : kLayers) {
    if (kind.reader.fill == nullptr || !names.contains(std::string(kind.name))) continue;
    Output output{&kind.reader, {}};
    for (const Channel& channel : kind.reader.channels())
      output.targets.push_back({*layout.SlotOf(channel.name), channel.rule == MergeRule::kSum});
    TESSERA_CHECK(output.targets.size() <= kLayerChannelsMax);
    outputs_.push_back(std::move(output));
  }
}

void LayerRecorder::Start(const SampledWavelengths& wavelengths, float filter_weight, float* values) {
  wavelengths_ = wavelengths;
  filter_weight_ = filter_weight;
  values_ = values;
}

void LayerRecorder::AddFirstHit(const FirstHit& first) {
  for (const Output& output : outputs_) {
    float layer[kLayerChannelsMax] = {};
    output.layer->fill({first, wavelengths_, sensor_}, layer);
    for (size_t i = 0; i < output.targets.size(); ++i) {
      // A tile must not hold NaN or infinite values, which degenerate geometry can give.
      if (!std::isfinite(layer[i])) continue;
      const Target& target = output.targets[i];
      values_[target.slot] = target.is_weighted ? layer[i] * filter_weight_ : layer[i];
    }
  }
}

}  // namespace tessera
