// Renders a tile several samples at a time (PathBatch).
#pragma once

#include <array>

#include "renderer/integrator/path_batch.h"
#include "renderer/scene/sample_cursor.h"
#include "renderer/scene/sample_renderer.h"

namespace tessera {

class BatchRenderer {
 public:
  // All must outlive it. PathBatch::Follows the paths of the scene, and `renderer` records no more than
  // radiance.
  BatchRenderer(const Scene::Data& data, const TileWork& work, RayCounts& rays, SampleRenderer& renderer,
                TileBuilder& tile);

  // Returns whether all samples were rendered.
  bool Render();

 private:
  // Samples that are started and not yet added: a path of many vertices keeps those after it waiting.
  static constexpr size_t kPendingMax = 64;
  struct Pending {
    PixelSample sample;
    SampledWavelengths wavelengths;
    SampledSpectrum radiance;
    bool has_ended = false;
  };

  // Starts the next sample in a free lane, unless there is none or too many are pending.
  void StartIn(int lane);
  void End(int lane);
  // Adds those that have ended, as far as the tile's order allows.
  void AddEnded();

  const TileWork& work_;
  SampleRenderer& renderer_;
  TileBuilder& tile_;
  PathBatch batch_;
  SampleCursor to_start_, to_add_;
  size_t started_ = 0, added_ = 0;            // samples
  std::array<Pending, kPendingMax> pending_;  // by the number of the sample
  std::array<size_t, kLanes> numbers_{};      // of the sample in each lane
};

}  // namespace tessera
