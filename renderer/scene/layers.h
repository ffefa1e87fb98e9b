// The layers that a picture may have beside its colours (--aov). Each is a row of the table in layers.cpp:
// its channels, and how the first surface that a sample sees fills them.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "renderer/description/kind_table.h"
#include "renderer/film/channel.h"
#include "renderer/film/channel_layout.h"
#include "renderer/integrator/sample_record.h"
#include "renderer/scene/film_sensor.h"

namespace tessera {

// What a layer sees of a sample.
struct LayerSample {
  const FirstHit& first;
  const SampledWavelengths& wavelengths;
  const FilmSensor& sensor;
};

struct Layer {
  std::vector<Channel> (*channels)() = nullptr;
  // Writes one value per channel. Null if the film fills the layer by itself.
  void (*fill)(const LayerSample& sample, float* values) = nullptr;
};

KindTable<Layer> Layers();

// The channels of a frame with these layers, which are names in Layers().
void AddLayers(const std::set<std::string>& names, std::vector<Channel>& channels);

// Writes what the samples of one frame report into their values, by position. Used by one thread.
class LayerRecorder : public SampleRecorder {
 public:
  LayerRecorder(const std::set<std::string>& names, const ChannelLayout& layout, const FilmSensor& sensor);

  // Whether there is nothing to write.
  bool empty() const { return outputs_.empty(); }
  // A sample starts. `values` are its values, all zero, which outlive it; so do the wavelengths.
  void Start(const SampledWavelengths& wavelengths, float filter_weight, float* values);

  void Add(SampledSpectrum, const LightPath&) override {}
  void AddFirstHit(const FirstHit& first) override;

 private:
  struct Target {
    size_t slot = 0;  // in the values of a sample
    bool is_weighted = false;
  };
  struct Output {
    const Layer* layer = nullptr;
    std::vector<Target> targets;  // of its channels
  };

  const FilmSensor& sensor_;
  std::vector<Output> outputs_;
  SampledWavelengths wavelengths_{};
  float filter_weight_ = 0;
  float* values_ = nullptr;
};

}  // namespace tessera
