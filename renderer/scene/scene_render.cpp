#include "renderer/scene/batch_renderer.h"
#include "renderer/scene/scene.h"

namespace tessera {
namespace {

// One sample after the other. Returns whether all were rendered.
bool RenderInOrder(const Scene::Data& data, const TileWork& work, RayCounts& rays, SampleRenderer& renderer,
                   TileBuilder& tile) {
  Sampler sampler = data.sampler.sampler;
  for (SampleCursor next(work); !next.at_end();) {
    if (work.IsStopped()) return false;
    if (!next.HasSamples()) {
      tile.SkipPixel();
      next.NextPixel();
      continue;
    }
    bool is_last = false;
    while (!is_last) {
      SampledWavelengths wavelengths;
      const PixelSample sample = renderer.Start(next.x(), next.y(), next.index(), sampler, &wavelengths);
      const PathContext context{data.world, data.estimator.path, wavelengths, sampler, rays};
      SampledSpectrum radiance(0.0f);
      if (sample.seen.weight > 0) {
        radiance = renderer.records()
                       ? EstimateRadiance(context, data.estimator, sample.seen.ray, renderer.recorder())
                       : EstimateRadiance(context, data.estimator, sample.seen.ray);
      }
      renderer.Finish(sample, radiance, wavelengths, tile);
      is_last = next.Next();
    }
    tile.EndPixel();
  }
  return true;
}

}  // namespace

std::optional<RadianceTile> Scene::Render(PixelBounds bounds, const PixelMask& pixels, SampleRange range,
                                          const std::atomic<bool>* stop, RenderStatistics* statistics) const {
  TESSERA_CHECK(data_->world.accelerator != nullptr);
  TESSERA_CHECK(range.IsDyadic() && bounds.width() > 0 && bounds.height() > 0);
  RenderStatistics own;
  RenderStatistics& counted = statistics != nullptr ? *statistics : own;
  const ChannelLayout layout = data_->frame.Layout();
  SampleRenderer renderer(*data_, layout, counted);
  TileBuilder tile(layout, bounds, range);
  const TileWork work{bounds, pixels, range, stop};
  RayCounts rays;
  const bool in_batches = !renderer.records() && PathBatch::Follows(data_->world, data_->estimator);
  const bool is_complete = in_batches ? BatchRenderer(*data_, work, rays, renderer, tile).Render()
                                      : RenderInOrder(*data_, work, rays, renderer, tile);
  if (!is_complete) return std::nullopt;
  counted.camera_rays += rays.camera;
  counted.bounce_rays += rays.bounce;
  counted.shadow_rays += rays.shadow;
  return tile.Take();
}

}  // namespace tessera
