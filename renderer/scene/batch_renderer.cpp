#include "renderer/scene/batch_renderer.h"

namespace tessera {

BatchRenderer::BatchRenderer(const Scene::Data& data, const TileWork& work, RayCounts& rays,
                             SampleRenderer& renderer, TileBuilder& tile)
    : work_(work),
      renderer_(renderer),
      tile_(tile),
      batch_(data.world, data.estimator, data.sampler.sampler, rays),
      to_start_(work),
      to_add_(work) {}

bool BatchRenderer::Render() {
  while (!to_add_.at_end()) {
    if (work_.IsStopped()) return false;
    ForEachLane(batch_.free_lanes(), [&](int lane) { StartIn(lane); });
    ForEachLane(batch_.Extend(), [&](int lane) { End(lane); });
    AddEnded();
  }
  return true;
}

void BatchRenderer::StartIn(int lane) {
  while (!to_start_.at_end() && started_ - added_ < kPendingMax) {
    if (!to_start_.HasSamples()) {
      to_start_.NextPixel();
      continue;
    }
    Pending& pending = pending_[started_ % kPendingMax];
    SampledWavelengths& wavelengths = batch_.wavelengths(lane);
    pending.sample =
        renderer_.Start(to_start_.x(), to_start_.y(), to_start_.index(), batch_.sampler(lane), &wavelengths);
    to_start_.Next();
    numbers_[lane] = started_++;
    pending.has_ended = !(pending.sample.seen.weight > 0);
    if (!pending.has_ended) return batch_.Start(lane, pending.sample.seen.ray);
    pending.wavelengths = wavelengths;
    pending.radiance = SampledSpectrum(0.0f);
  }
}

void BatchRenderer::End(int lane) {
  Pending& pending = pending_[numbers_[lane] % kPendingMax];
  pending.wavelengths = batch_.wavelengths(lane);
  pending.radiance = batch_.radiance(lane);
  pending.has_ended = true;
}

void BatchRenderer::AddEnded() {
  while (!to_add_.at_end()) {
    if (!to_add_.HasSamples()) {
      tile_.SkipPixel();
      to_add_.NextPixel();
      continue;
    }
    const Pending& pending = pending_[added_ % kPendingMax];
    if (added_ == started_ || !pending.has_ended) return;
    renderer_.Finish(pending.sample, pending.radiance, pending.wavelengths, tile_);
    ++added_;
    if (to_add_.Next()) tile_.EndPixel();
  }
}

}  // namespace tessera
