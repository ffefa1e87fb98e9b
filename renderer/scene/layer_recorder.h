// Writes what the samples of a frame report into the values of its layers.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "renderer/film/channel_layout.h"
#include "renderer/film/tile_builder.h"
#include "renderer/scene/layers.h"

namespace tessera {

// Used by one thread. Layers that the layout has no channels of cost nothing.
class LayerRecorder : public SampleRecorder {
 public:
  LayerRecorder(const LayerScene& scene, const ChannelLayout& layout);

  // Whether there is nothing to write.
  bool empty() const { return outputs_.empty() && group_slots_.empty(); }

  // A sample starts. The wavelengths are those of its path before that is traced.
  void Start(const SampledWavelengths& wavelengths);
  // What is known of the sample when its path is complete. Without `rgb` its radiance is not finite, and it
  // counts as black.
  struct End {
    uint32_t index = 0;
    Point2 film;
    float time_s = 0;
    float filter_weight = 1;
    std::optional<Rgb> rgb;
    SampleExposure exposure;
  };
  // Writes the values of the tile's next sample, all of which are zero.
  void Finish(const End& end, TileBuilder& tile);

  void Add(SampledSpectrum contribution, const LightPath& path) override;
  void AddFirstHit(const FirstHit& first) override;
  void AddMirrored(const MirroredSurface& mirrored) override { parts_.mirrored = mirrored; }
  void AddShadow(SampledSpectrum blocked) override { parts_.shadow += blocked; }
  void Escape(SampledSpectrum transmittance) override { parts_.transmittance = transmittance; }

 private:
  struct Output {
    const Layer* layer = nullptr;
    std::vector<size_t> slots;  // of its channels in the values of a sample; of ids the number of the set
  };

  void AddOutput(const Kind<Layer>& kind, const ChannelLayout& layout);
  void AddGroups(const ChannelLayout& layout);
  void WriteGroups(const LayerSample& sample, float filter_weight, float* values) const;

  const LayerScene scene_;
  std::vector<Output> outputs_;
  std::vector<std::array<size_t, 3>> group_slots_;  // of the groups of lights; none without their layer
  SampledWavelengths first_wavelengths_{};
  SampleParts parts_;
};

}  // namespace tessera
