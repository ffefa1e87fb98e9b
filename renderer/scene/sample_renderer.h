// Makes the samples of pixels and adds what they yield to a tile.
#pragma once

#include <array>

#include "renderer/film/tile_builder.h"
#include "renderer/scene/layer_recorder.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/scene_data.h"

namespace tessera {

// A sample on its way from the film to the tile.
struct PixelSample {
  uint32_t index = 0;
  FilterSample filter;
  Point2 film;  // pixels from the upper left corner
  CameraSample seen;
};

// Used by one thread.
class SampleRenderer {
 public:
  // All must outlive it.
  SampleRenderer(const Scene::Data& data, const ChannelLayout& layout, RenderStatistics& statistics);

  // Whether more than the radiance of a sample is recorded, by `recorder`: then a sample is finished before
  // the next one is started.
  bool records() const { return !layers_.empty(); }
  LayerRecorder& recorder() { return layers_; }

  // Starts sample `index` of pixel (x, y) of `sampler`, and chooses its wavelengths.
  PixelSample Start(int x, int y, uint32_t index, Sampler& sampler, SampledWavelengths* wavelengths);
  // Adds the sample to the tile. `radiance` arrives along the camera ray, at `wavelengths`.
  void Finish(const PixelSample& sample, SampledSpectrum radiance, const SampledWavelengths& wavelengths,
              TileBuilder& tile);

 private:
  const Scene::Data& data_;
  const std::array<size_t, 3> rgb_;  // positions of the channels
  const size_t weight_;
  LayerRecorder layers_;
  BucketRecorder buckets_;
  RenderStatistics& statistics_;
};

}  // namespace tessera
