#include "renderer/light/light.h"
#include "renderer/light/light_data.h"

namespace tessera {
namespace {

// Samples whichever kind a source is.
struct SourceSampler {
  const ReferencePoint& reference;
  Point2 u;
  float scene_radius;
  const SampledWavelengths& wavelengths;

  template <typename PointLike>
  std::optional<LightSample> operator()(const PointLike& light) const {
    return light.Sample(reference, wavelengths);
  }
  std::optional<LightSample> operator()(const DistantLight& light) const {
    return light.Sample(reference, scene_radius, wavelengths);
  }
  std::optional<LightSample> operator()(const ImageInfiniteLight& light) const {
    return light.Sample(reference, u, scene_radius, wavelengths);
  }
  std::optional<LightSample> operator()(const ConstantInfiniteLight&) const { return std::nullopt; }
};

}  // namespace

LightTable::LightTable() : data_(std::make_unique<Data>()) {}
LightTable::~LightTable() = default;
LightTable::LightTable(LightTable&&) noexcept = default;
LightTable& LightTable::operator=(LightTable&&) noexcept = default;

std::optional<ChosenLight> LightTable::Choose(const ReferencePoint& reference, float u) const {
  return data_->chooser.Choose(reference, u);
}

float LightTable::ChoosePmf(const ReferencePoint& reference, int light) const {
  return data_->chooser.Pmf(reference, light);
}

std::optional<LightSample> LightTable::Sample(int light, const ReferencePoint& reference, Point2 u,
                                              const SampledWavelengths& wavelengths) const {
  const Data& data = *data_;
  if (!data.IsSource(light)) {
    return data.areas.Sample(data.AreaIndex(light), reference, u, wavelengths, *data.textures);
  }
  return std::visit(SourceSampler{reference, u, data.scene_radius, wavelengths},
                    data.sources[static_cast<size_t>(light)]);
}

float LightTable::AreaLightPdf(int light, const ReferencePoint& reference, Vec3 wi,
                               const SurfaceInteraction& on_light) const {
  return data_->areas.Pdf(data_->AreaIndex(light), reference, wi, on_light);
}

float LightTable::InfiniteLightPdf(int light, Vec3 wi) const {
  const auto* image = std::get_if<ImageInfiniteLight>(&data_->sources[static_cast<size_t>(light)]);
  return image ? image->Pdf(wi) : 0;
}

SampledSpectrum LightTable::EmittedRadiance(int light, const SurfaceInteraction& on_light, Vec3 wo,
                                            const SampledWavelengths& wavelengths) const {
  return data_->areas.Radiance(data_->AreaIndex(light), on_light, wo, wavelengths);
}

SampledSpectrum LightTable::InfiniteRadiance(int light, Vec3 d, const SampledWavelengths& wavelengths) const {
  const SourceLight& source = data_->sources[static_cast<size_t>(light)];
  if (const auto* constant = std::get_if<ConstantInfiniteLight>(&source))
    return constant->L.Sample(wavelengths);
  if (const auto* image = std::get_if<ImageInfiniteLight>(&source)) return image->Radiance(d, wavelengths);
  return SampledSpectrum();
}

std::span<const int> LightTable::infinite_lights() const {
  return data_->infinite;
}

size_t LightTable::size() const {
  return data_->sources.size() + data_->areas.size();
}

}  // namespace tessera
