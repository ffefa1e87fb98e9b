#include "renderer/light/light.h"
#include "renderer/light/light_data.h"
#include "renderer/math/flat_transform.h"
#include "renderer/shape/moved_sampling.h"
#include "renderer/util/dispatch.h"

namespace tessera {
namespace {

template <typename Light>
std::optional<LightSample> SampleMoving(const Light& light, const LightMotion& motion,
                                        const LightQuery& query) {
  const Transform render_from_base = motion.RenderFromBase(query.reference.time);
  if (IsFlat(render_from_base)) return std::nullopt;
  const ReferencePoint there = MoveReference(render_from_base, query.reference);
  const std::optional<LightSample> sample =
      light.Sample({there, query.u, query.scene_radius, query.wavelengths});
  if (!sample) return std::nullopt;
  return MoveSample(render_from_base, *sample, motion.is_infinite(), there, query.reference,
                    query.scene_radius);
}

}  // namespace

LightTable::LightTable() : data_(std::make_unique<Data>()) {}
LightTable::~LightTable() = default;
LightTable::LightTable(LightTable&&) noexcept = default;
LightTable& LightTable::operator=(LightTable&&) noexcept = default;

int LightTable::SampledFor(int light) const {
  const Data& data = *data_;
  if (data.IsSource(light)) return light;
  return data.AreaLight(data.areas.SampledFor(data.AreaIndex(light)));
}

std::optional<ChosenLight> LightTable::Choose(const ReferencePoint& reference, float u) const {
  return data_->chooser.Choose(reference, u);
}

std::optional<ChosenLight> LightTable::OnlyLight() const {
  return data_->chooser.OnlyLight();
}

float LightTable::ChoosePmf(const ReferencePoint& reference, int light) const {
  return data_->chooser.Pmf(reference, SampledFor(light));
}

std::optional<BoundingSphere> LightTable::SphereOf(int light) const {
  return data_->chooser.SphereOf(SampledFor(light));
}

bool LightTable::has_spheres() const {
  return data_->chooser.has_spheres();
}

std::optional<ChosenLight> LightTable::ChooseAlong(const Ray& ray, float extinction, float u) const {
  return data_->chooser.ChooseAlong(ray, extinction, u);
}

float LightTable::ChoosePmfAlong(const Ray& ray, float extinction, int light) const {
  return data_->chooser.PmfAlong(ray, extinction, SampledFor(light));
}

std::optional<ShapeSample> LightTable::SamplePoint(int light, const ReferencePoint& reference,
                                                   Point2 u) const {
  return data_->areas.SamplePoint(data_->AreaIndex(light), reference, u);
}

std::optional<LightSample> LightTable::Sample(int light, const ReferencePoint& reference, Point2 u,
                                              const SampledWavelengths& wavelengths) const {
  const Data& data = *data_;
  if (!data.IsSource(light)) {
    return data.areas.Sample(data.AreaIndex(light), reference, u, wavelengths, *data.textures);
  }
  const LightQuery query{reference, u, data.scene_radius, wavelengths};
  const LightMotion* const motion = data.MotionOf(light);
  return Dispatch(data.Source(light), [&](const auto& source) {
    return motion == nullptr ? source.Sample(query) : SampleMoving(source, *motion, query);
  });
}

std::optional<RectangleLight> LightTable::RectangleOf(int light) const {
  if (data_->IsSource(light)) return std::nullopt;
  return data_->areas.RectangleOf(data_->AreaIndex(light));
}

float LightTable::AreaLightPdf(int light, const ReferencePoint& reference, Vec3 wi,
                               const SurfaceInteraction& on_light) const {
  return data_->areas.Pdf(data_->AreaIndex(light), reference, wi, on_light);
}

float LightTable::InfiniteLightPdf(int light, Point3 from, Vec3 wi, float time_s) const {
  const LightMotion* const motion = data_->MotionOf(light);
  return Dispatch(data_->Source(light), [&]<typename Light>(const Light& source) -> float {
    if constexpr (HitByRays<Light>) {
      if (motion == nullptr) return source.Pdf(from, wi);
      const Transform render_from_base = motion->RenderFromBase(time_s);
      if (IsFlat(render_from_base)) return 0;
      const Transform base_from_render = render_from_base.Inverse();
      const float at_base =
          source.Pdf(base_from_render.ToPoint(from), Normalize(base_from_render.ToVector(wi)));
      return at_base * SolidAngleRatio(render_from_base, wi);
    }
    return 0;
  });
}

SampledSpectrum LightTable::EmittedRadiance(int light, const SurfaceInteraction& on_light, Vec3 wo,
                                            const SampledWavelengths& wavelengths) const {
  return data_->areas.Radiance(data_->AreaIndex(light), on_light, wo, wavelengths);
}

SampledSpectrum LightTable::InfiniteRadiance(int light, Point3 from, Vec3 d, float time_s,
                                             const SampledWavelengths& wavelengths) const {
  const LightMotion* const motion = data_->MotionOf(light);
  return Dispatch(data_->Source(light), [&]<typename Light>(const Light& source) -> SampledSpectrum {
    if constexpr (HitByRays<Light>) {
      if (motion == nullptr) return source.Radiance(from, d, wavelengths);
      const Transform render_from_base = motion->RenderFromBase(time_s);
      if (IsFlat(render_from_base)) return SampledSpectrum();
      const Transform base_from_render = render_from_base.Inverse();
      return source.Radiance(base_from_render.ToPoint(from), Normalize(base_from_render.ToVector(d)),
                             wavelengths);
    }
    return SampledSpectrum();
  });
}

bool LightTable::IsHitByScatteredRays(int light) const {
  if (!data_->IsSource(light)) return data_->areas.IsHitByScatteredRays(data_->AreaIndex(light));
  return Dispatch(data_->Source(light), []<typename Light>(const Light&) { return HitByRays<Light>; });
}

std::span<const int> LightTable::infinite_lights() const {
  return data_->infinite;
}

size_t LightTable::size() const {
  return data_->sources.size() + data_->areas.size();
}

}  // namespace tessera
