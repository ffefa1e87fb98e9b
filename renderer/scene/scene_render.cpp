#include <array>

#include "renderer/film/dyadic_sum.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/scene_data.h"

namespace tessera {
namespace {

// Renders samples of single pixels on one thread.
class PixelRenderer {
 public:
  PixelRenderer(const Scene::Data& data, RenderStatistics* statistics)
      : data_(data), sampler_(data.sampler.sampler), statistics_(*statistics) {}

  // The sums R G B W of samples `range` of pixel (x, y).
  Float4 Render(int x, int y, SampleRange range) {
    sum_.Clear();
    for (uint32_t index = range.begin; index < range.end(); ++index) sum_.Add(Sample(x, y, index));
    return sum_.Node();
  }

  void ReportRays() {
    statistics_.camera_rays += rays_.camera;
    statistics_.bounce_rays += rays_.bounce;
    statistics_.shadow_rays += rays_.shadow;
  }

 private:
  Float4 Sample(int x, int y, uint32_t index) {
    sampler_.StartSample(x, y, index);
    const FilterSample filter = data_.filter.Sample(sampler_.Get2D());
    SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(sampler_.Get1D());
    const Camera& camera = data_.world.camera;
    const Point2 u_lens = camera.has_lens() ? sampler_.Get2D() : Point2{0.5f, 0.5f};
    const Point2 film{static_cast<float>(x) + 0.5f + filter.offset.x,
                      static_cast<float>(y) + 0.5f + filter.offset.y};
    const Ray ray = camera.GenerateRay(film, u_lens, 0.5f);
    const PathContext context{data_.world, data_.estimator.path, wavelengths, sampler_, rays_};
    const SampledSpectrum radiance = EstimateRadiance(context, data_.estimator, ray);
    const Rgb rgb = data_.sensor.ToRgb(radiance, wavelengths);
    if (!IsFinite(rgb)) {
      ++statistics_.discarded_samples;
      return {0, 0, 0, filter.weight};
    }
    return Float4(rgb.x, rgb.y, rgb.z, 1) * filter.weight;
  }

  const Scene::Data& data_;
  Sampler sampler_;
  RayCounts rays_;
  RenderStatistics& statistics_;
  DyadicSum<Float4> sum_;
};

}  // namespace

std::optional<RadianceTile> Scene::Render(PixelBounds bounds, const PixelMask& pixels, SampleRange range,
                                          const std::atomic<bool>* stop, RenderStatistics* statistics) const {
  TESSERA_CHECK(data_->world.accelerator != nullptr);
  TESSERA_CHECK(range.IsDyadic() && bounds.width() > 0 && bounds.height() > 0);
  RenderStatistics own;
  PixelRenderer renderer(*data_, statistics != nullptr ? statistics : &own);
  const FrameSpec& frame = data_->frame;
  RadianceTile tile{bounds, range, frame.channel_count(), {}};
  tile.sums.reserve(static_cast<size_t>(bounds.area()) * frame.channels.size());
  size_t pixel = 0;
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    for (int x = bounds.x0; x < bounds.x1; ++x, ++pixel) {
      if (stop != nullptr && stop->load(std::memory_order_relaxed)) return std::nullopt;
      const bool wanted = pixels.Has(pixel);
      alignas(16) std::array<float, 4> rgbw{};
      if (wanted) _mm_store_ps(rgbw.data(), renderer.Render(x, y, range).v);
      tile.sums.insert(tile.sums.end(), rgbw.begin(), rgbw.end() - 1);
      if (frame.IsAdaptive()) tile.sums.push_back(wanted ? static_cast<float>(range.size) : 0.0f);
      tile.sums.push_back(rgbw.back());
    }
  }
  renderer.ReportRays();
  return tile;
}

}  // namespace tessera
