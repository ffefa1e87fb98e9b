#include "renderer/scene/sample_renderer.h"

namespace tessera {

SampleRenderer::SampleRenderer(const Scene::Data& data, const ChannelLayout& layout,
                               RenderStatistics& statistics)
    : data_(data),
      rgb_{*layout.SlotOf("R"), *layout.SlotOf("G"), *layout.SlotOf("B")},
      weight_(layout.weight()),
      layers_({data.world, data.sensor, data.light_groups, data.mattes, data.gbuffer, data.footprint_scale,
               data.motion_times},
              layout),
      buckets_(data.buckets, layout),
      statistics_(statistics) {}

PixelSample SampleRenderer::Start(int x, int y, uint32_t index, Sampler& sampler,
                                  SampledWavelengths* wavelengths) {
  // SobolSampler takes the dimensions of its sequence in an order that suits the order of these numbers and
  // of those that a path draws at its first vertex.
  sampler.StartSample(x, y, index);
  PixelSample sample{index, data_.filter.Sample(sampler.Get2D()), {}, {}};
  const float u_wavelengths = sampler.Get1D();
  *wavelengths = SampledWavelengths::SampleVisible(data_.wavelength_jitter ? u_wavelengths : 0.5f);
  const Camera& camera = data_.world.camera;
  Point2 u_lens = camera.has_lens() ? sampler.Get2D() : Point2{0.5f, 0.5f};
  float u_time = data_.world.moves && !data_.is_moment ? sampler.Get1D() : 0.5f;
  if (!data_.pixel_jitter) {
    sample.filter = {{0, 0}, 1};
    u_lens = {0.5f, 0.5f};
    u_time = 0.5f;
  }
  if (data_.is_moment) u_time = 0;
  sample.film = {static_cast<float>(x) + 0.5f + sample.filter.offset.x,
                 static_cast<float>(y) + 0.5f + sample.filter.offset.y};
  sample.seen = camera.GenerateRay(sample.film, u_lens, u_time);
  if (records()) layers_.Start(*wavelengths);
  return sample;
}

void SampleRenderer::Finish(const PixelSample& sample, SampledSpectrum radiance,
                            const SampledWavelengths& wavelengths, TileBuilder& tile) {
  float* const values = tile.Values();
  radiance *= sample.seen.weight;
  const Rgb rgb = data_.sensor.ToRgb(radiance, wavelengths);
  const float weight = sample.filter.weight;
  values[weight_] = weight;
  if (records()) {
    const SampleExposure exposure{wavelengths, sample.seen.weight, data_.sensor.Limit(radiance, wavelengths)};
    const auto finite = IsFinite(rgb) ? std::optional<Rgb>(rgb) : std::nullopt;
    layers_.Finish({sample.index, sample.film, sample.seen.ray.time, weight, finite, exposure}, tile);
  }
  if (IsFinite(rgb)) {
    values[rgb_[0]] = rgb.x * weight;
    values[rgb_[1]] = rgb.y * weight;
    values[rgb_[2]] = rgb.z * weight;
    if (!buckets_.empty()) buckets_.Add(radiance, wavelengths, weight, values);
  } else {
    ++statistics_.discarded_samples;
  }
  tile.AddSample();
}

}  // namespace tessera
