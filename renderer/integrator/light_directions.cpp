#include "renderer/integrator/light_directions.h"

#include "renderer/shape/moved_sampling.h"
#include "renderer/shape/ray_crossings.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {

LightDirections::LightDirections(const World& world) : world_(world) {
  std::vector<Bounds3> boxes;
  const Geometry& geometry = world.geometry;
  for (uint32_t s = 0; s < geometry.shapes.size(); ++s) AddShape(Hit::kNoInstance, s, &boxes);
  for (uint32_t i = 0; i < geometry.instances.size(); ++i) {
    if (geometry.instances[i].motion < 0) continue;
    const size_t count = geometry.groups[geometry.instances[i].group].shapes.size();
    for (uint32_t s = 0; s < count; ++s) AddShape(i, s, &boxes);
  }
  tree_ = EmitterTree(boxes);
  constexpr float kAnyChoice = 0.5f;
  empty_ = emitters_.empty() && !world.lights.Choose({}, kAnyChoice);
}

void LightDirections::AddShape(uint32_t instance, uint32_t index, std::vector<Bounds3>* boxes) {
  const Shape& shape = ShapeOf(world_.geometry, instance, index);
  const int light = shape.surface.area_light;
  if (light < 0) return;
  const uint32_t count = shape.PrimitiveCount();
  for (uint32_t i = 0; i < count; ++i) {
    emitters_.push_back({index, i, light + static_cast<int>(i), instance});
    const Bounds3 bounds = ShapeBounds(shape, i);
    boxes->push_back(instance == Hit::kNoInstance
                         ? bounds
                         : world_.geometry.InstanceBounds(world_.geometry.instances[instance], bounds));
  }
}

std::optional<LightDirections::Drawn> LightDirections::Sample(const ReferencePoint& reference, float u_choice,
                                                              Point2 u,
                                                              const SampledWavelengths& wavelengths) const {
  const std::optional<ChosenLight> chosen = world_.lights.Choose(reference, u_choice);
  if (!chosen) return std::nullopt;
  if (emitters_.empty() || chosen->light < emitters_.front().light) {  // at infinity
    const auto sample = world_.lights.Sample(chosen->light, reference, u, wavelengths);
    if (!sample) return std::nullopt;
    return Drawn{sample->wi, chosen->pmf * sample->pdf};
  }
  const Emitter& emitter = emitters_[static_cast<size_t>(chosen->light - emitters_.front().light)];
  const std::optional<ShapeSample> on_shape = world_.lights.SamplePoint(emitter.light, reference, u);
  if (!on_shape || !(on_shape->pdf > 0)) return std::nullopt;
  const Vec3 to_light = on_shape->p - reference.p;
  if (!(LengthSquared(to_light) > 0)) return std::nullopt;
  const Vec3 wi = Normalize(to_light);
  SurfaceInteraction on_light;
  on_light.p = on_shape->p;
  on_light.n = on_shape->n;
  on_light.uv = on_shape->uv;
  if (!AnyNonZero(world_.lights.EmittedRadiance(emitter.light, on_light, -wi, wavelengths)))
    return std::nullopt;
  return Drawn{wi, chosen->pmf * on_shape->pdf};
}

float LightDirections::EmitterPdf(const Emitter& emitter, const ReferencePoint& reference, const Ray& ray,
                                  const SampledWavelengths& wavelengths) const {
  const Shape& shape = ShapeOf(world_.geometry, emitter.instance, emitter.shape);
  const InstancePlace place(world_.geometry, emitter.instance, reference.time);
  if (place.is_flat()) return 0;
  const Transform* const moved = place.render_from_group();
  Hit hits[kCrossingsMax];
  const int count = RayCrossings(
      shape, {ray, moved},
      {.shape = emitter.shape, .primitive = emitter.primitive, .instance = emitter.instance}, hits);
  float pdf = 0;
  for (int i = 0; i < count; ++i) {
    const SurfaceInteraction on_light = MakeInteraction(world_.geometry, hits[i], ray);
    if (!AnyNonZero(world_.lights.EmittedRadiance(emitter.light, on_light, -ray.d, wavelengths))) continue;
    pdf += world_.lights.AreaLightPdf(emitter.light, reference, ray.d, on_light);
  }
  return pdf > 0 ? pdf * world_.lights.ChoosePmf(reference, emitter.light) : 0;
}

float LightDirections::Pdf(const ReferencePoint& reference, const Ray& ray,
                           const SampledWavelengths& wavelengths) const {
  float pdf = 0;
  tree_.ForEachAlong(
      ray, [&](uint32_t index) { pdf += EmitterPdf(emitters_[index], reference, ray, wavelengths); });
  for (const int light : world_.lights.infinite_lights()) {
    const float infinite_pdf = world_.lights.InfiniteLightPdf(light, reference.p, ray.d, ray.time);
    if (infinite_pdf > 0) pdf += infinite_pdf * world_.lights.ChoosePmf(reference, light);
  }
  return pdf;
}

}  // namespace tessera
