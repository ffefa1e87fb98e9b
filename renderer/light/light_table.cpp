#include "renderer/light/light.h"
#include "renderer/light/light_data.h"
#include "renderer/util/dispatch.h"

namespace tessera {
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
  const LightQuery query{reference, u, data.scene_radius, wavelengths};
  return Dispatch(data.Source(light), [&](const auto& source) { return source.Sample(query); });
}

float LightTable::AreaLightPdf(int light, const ReferencePoint& reference, Vec3 wi,
                               const SurfaceInteraction& on_light) const {
  return data_->areas.Pdf(data_->AreaIndex(light), reference, wi, on_light);
}

float LightTable::InfiniteLightPdf(int light, Point3 from, Vec3 wi) const {
  return Dispatch(data_->Source(light), [&]<typename Light>(const Light& source) -> float {
    if constexpr (HitByRays<Light>) return source.Pdf(from, wi);
    return 0;
  });
}

SampledSpectrum LightTable::EmittedRadiance(int light, const SurfaceInteraction& on_light, Vec3 wo,
                                            const SampledWavelengths& wavelengths) const {
  return data_->areas.Radiance(data_->AreaIndex(light), on_light, wo, wavelengths);
}

SampledSpectrum LightTable::InfiniteRadiance(int light, Point3 from, Vec3 d,
                                             const SampledWavelengths& wavelengths) const {
  return Dispatch(data_->Source(light), [&]<typename Light>(const Light& source) -> SampledSpectrum {
    if constexpr (HitByRays<Light>) return source.Radiance(from, d, wavelengths);
    return SampledSpectrum();
  });
}

bool LightTable::IsHitByRays(int light) const {
  if (!data_->IsSource(light)) return data_->areas.IsHitByRays(data_->AreaIndex(light));
  return Dispatch(data_->Source(light), []<typename Light>(const Light&) { return HitByRays<Light>; });
}

std::span<const int> LightTable::infinite_lights() const {
  return data_->infinite;
}

size_t LightTable::size() const {
  return data_->sources.size() + data_->areas.size();
}

}  // namespace tessera
