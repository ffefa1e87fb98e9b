#include <array>

#include "renderer/film/tile_builder.h"
#include "renderer/scene/layer_recorder.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/scene_data.h"

namespace tessera {
namespace {

// Renders samples of single pixels on one thread.
class PixelRenderer {
 public:
  PixelRenderer(const Scene::Data& data, const ChannelLayout& layout, RenderStatistics* statistics)
      : data_(data),
        sampler_(data.sampler.sampler),
        rgb_{*layout.SlotOf("R"), *layout.SlotOf("G"), *layout.SlotOf("B")},
        weight_(layout.weight()),
        layers_({data.world, data.sensor, data.light_groups, data.mattes, data.gbuffer, data.footprint_scale,
                 data.motion_times},
                layout),
        buckets_(data.buckets, layout),
        statistics_(*statistics) {}

  // Renders samples `range` of pixel (x, y).
  void Render(int x, int y, SampleRange range, TileBuilder& tile) {
    for (uint32_t index = range.begin; index < range.end(); ++index) {
      Sample(x, y, index, tile);
      tile.AddSample();
    }
    tile.EndPixel();
  }

  void ReportRays() {
    statistics_.camera_rays += rays_.camera;
    statistics_.bounce_rays += rays_.bounce;
    statistics_.shadow_rays += rays_.shadow;
  }

 private:
  void Sample(int x, int y, uint32_t index, TileBuilder& tile) {
    float* const values = tile.Values();
    // SobolSampler takes the dimensions of its sequence in an order that suits the order of these numbers and
    // of those that a path draws at its first vertex.
    sampler_.StartSample(x, y, index);
    FilterSample filter = data_.filter.Sample(sampler_.Get2D());
    const float u_wavelengths = sampler_.Get1D();
    SampledWavelengths wavelengths =
        SampledWavelengths::SampleVisible(data_.wavelength_jitter ? u_wavelengths : 0.5f);
    const Camera& camera = data_.world.camera;
    Point2 u_lens = camera.has_lens() ? sampler_.Get2D() : Point2{0.5f, 0.5f};
    float u_time = data_.world.moves && !data_.is_moment ? sampler_.Get1D() : 0.5f;
    if (!data_.pixel_jitter) {
      filter = {{0, 0}, 1};
      u_lens = {0.5f, 0.5f};
      u_time = 0.5f;
    }
    if (data_.is_moment) u_time = 0;
    const Point2 film{static_cast<float>(x) + 0.5f + filter.offset.x,
                      static_cast<float>(y) + 0.5f + filter.offset.y};
    const CameraSample seen = camera.GenerateRay(film, u_lens, u_time);
    const PathContext context{data_.world, data_.estimator.path, wavelengths, sampler_, rays_};
    SampledSpectrum radiance(0.0f);
    if (!layers_.empty()) layers_.Start(wavelengths);
    if (seen.weight > 0) radiance = Estimate(context, seen.ray) * seen.weight;
    const Rgb rgb = data_.sensor.ToRgb(radiance, wavelengths);
    values[weight_] = filter.weight;
    if (!layers_.empty()) {
      const SampleExposure exposure{wavelengths, seen.weight, data_.sensor.Limit(radiance, wavelengths)};
      const auto finite = IsFinite(rgb) ? std::optional<Rgb>(rgb) : std::nullopt;
      layers_.Finish({index, film, seen.ray.time, filter.weight, finite, exposure}, tile);
    }
    if (!IsFinite(rgb)) {
      ++statistics_.discarded_samples;
      return;
    }
    values[rgb_[0]] = rgb.x * filter.weight;
    values[rgb_[1]] = rgb.y * filter.weight;
    values[rgb_[2]] = rgb.z * filter.weight;
    if (!buckets_.empty()) buckets_.Add(radiance, wavelengths, filter.weight, values);
  }

  SampledSpectrum Estimate(const PathContext& context, const Ray& ray) {
    if (layers_.empty()) return EstimateRadiance(context, data_.estimator, ray);
    return EstimateRadiance(context, data_.estimator, ray, layers_);
  }

  const Scene::Data& data_;
  Sampler sampler_;
  const std::array<size_t, 3> rgb_;  // positions of the channels
  const size_t weight_;
  LayerRecorder layers_;
  BucketRecorder buckets_;
  RayCounts rays_;
  RenderStatistics& statistics_;
};

}  // namespace

std::optional<RadianceTile> Scene::Render(PixelBounds bounds, const PixelMask& pixels, SampleRange range,
                                          const std::atomic<bool>* stop, RenderStatistics* statistics) const {
  TESSERA_CHECK(data_->world.accelerator != nullptr);
  TESSERA_CHECK(range.IsDyadic() && bounds.width() > 0 && bounds.height() > 0);
  RenderStatistics own;
  const ChannelLayout layout = data_->frame.Layout();
  PixelRenderer renderer(*data_, layout, statistics != nullptr ? statistics : &own);
  TileBuilder tile(layout, bounds, range);
  size_t pixel = 0;
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    for (int x = bounds.x0; x < bounds.x1; ++x, ++pixel) {
      if (stop != nullptr && stop->load(std::memory_order_relaxed)) return std::nullopt;
      if (pixels.Has(pixel)) {
        renderer.Render(x, y, range, tile);
      } else {
        tile.SkipPixel();
      }
    }
  }
  renderer.ReportRays();
  return tile.Take();
}

}  // namespace tessera
