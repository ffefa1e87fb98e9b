// The layers that a picture may have beside its colours (--aov). Each is a row of the table in layers.cpp:
// its channels, and how the first surface that a sample sees fills them.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "renderer/description/kind_table.h"
#include "renderer/film/channel.h"
#include "renderer/film/channel_layout.h"
#include "renderer/film/tile_builder.h"
#include "renderer/integrator/sample_record.h"
#include "renderer/scene/film_sensor.h"
#include "renderer/scene/mattes.h"

namespace tessera {

// What a layer sees of a sample.
struct LayerSample {
  const FirstHit& first;
  const SampledWavelengths& wavelengths;
  const FilmSensor& sensor;
  const MatteTable& mattes;
};

struct Layer {
  std::vector<Channel> (*channels)() = nullptr;
  // Writes one value per channel, or the id that the sample sees. Null if the film fills the layer by itself.
  void (*fill)(const LayerSample& sample, float* values) = nullptr;
};

KindTable<Layer> Layers();

// The channels of a frame with these layers, which are names in Layers().
void AddLayers(const std::set<std::string>& names, std::vector<Channel>& channels);

// Whether a picture with these layers has mattes, so that what the scene holds must be named.
bool HasMattes(const std::set<std::string>& names);
// What the header of such a picture says of them.
void AddMatteNames(const std::set<std::string>& names, const MatteTable& mattes, const std::string& place,
                   Diagnostics& diagnostics, std::map<std::string, std::string>& attributes);

// Writes what the samples of one frame report into their values, by position. Used by one thread.
class LayerRecorder : public SampleRecorder {
 public:
  // All must outlive it.
  LayerRecorder(const std::set<std::string>& names, const ChannelLayout& layout, const FilmSensor& sensor,
                const MatteTable& mattes);

  // Whether there is nothing to write.
  bool empty() const { return outputs_.empty(); }
  // A sample starts, the next of the tile. Tile and wavelengths outlive it.
  void Start(const SampledWavelengths& wavelengths, float filter_weight, TileBuilder& tile);

  void Add(SampledSpectrum, const LightPath&) override {}
  void AddFirstHit(const FirstHit& first) override;

 private:
  struct Target {
    size_t slot = 0;  // in the values of a sample; of a set of ids its number
    MergeRule rule = MergeRule::kSum;
  };
  struct Output {
    const Layer* layer = nullptr;
    std::vector<Target> targets;  // of its channels
  };

  const FilmSensor& sensor_;
  const MatteTable& mattes_;
  std::vector<Output> outputs_;
  SampledWavelengths wavelengths_{};
  float filter_weight_ = 0;
  TileBuilder* tile_ = nullptr;
};

}  // namespace tessera
