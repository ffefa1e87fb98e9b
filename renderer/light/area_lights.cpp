#include "renderer/light/area_lights.h"

#include "renderer/light/emission.h"
#include "renderer/light/light_links.h"
#include "renderer/shape/moved_sampling.h"

namespace tessera {
namespace {

// The mean luminance over the surface, relative to that of L.
float MeanLuminance(const AreaEmitter& emitter) {
  if (emitter.image.empty()) return 1;
  return RelativeLuminance(emitter.image.color_space(), emitter.image.Mean());
}

// The strength of the mean radiance.
float MeanStrength(const AreaEmitter& emitter) {
  const float strength = Strength(emitter.L);
  if (emitter.image.empty()) return strength;
  const Rgb mean = emitter.image.Mean();
  return strength * (mean.x + mean.y + mean.z) / 3;
}

// The area of a primitive in rendering space; of a shape that moves, at the start. Returns nullopt if that
// depends on the place.
std::optional<float> AreaOf(const AreaEmitter& emitter, uint32_t primitive) {
  if (emitter.render_from_shape == nullptr) return ShapeArea(*emitter.shape, primitive);
  return MovedShapeArea(*emitter.shape, primitive, emitter.render_from_shape->At(emitter.times.start));
}

// For the choice between lights: never zero if the area is not.
float StrengthArea(const AreaEmitter& emitter, uint32_t primitive) {
  const float area = ShapeArea(*emitter.shape, primitive);
  const float at_start = AreaOf(emitter, primitive).value_or(area);
  return at_start > 0 ? at_start : area;
}

// At all times.
Bounds3 BoundsOf(const AreaEmitter& emitter, uint32_t primitive) {
  const Bounds3 bounds = ShapeBounds(*emitter.shape, primitive);
  if (emitter.render_from_shape == nullptr) return bounds;
  return emitter.render_from_shape->BoundsOf(bounds, emitter.times.start, emitter.times.end);
}
NormalCone NormalsOf(const AreaEmitter& emitter, uint32_t primitive) {
  return emitter.render_from_shape == nullptr ? ShapeNormals(*emitter.shape, primitive) : NormalCone();
}

// Whether sampling may go over the borders of triangles: nothing depends on their texture coordinates or
// moves.
bool CanJoin(const AreaEmitter& emitter) {
  return std::holds_alternative<TriangleMesh>(emitter.shape->form) && emitter.image.empty() &&
         !emitter.has_alpha && emitter.render_from_shape == nullptr;
}

AreaEmitter ReadEmitter(ParameterReader& reader, const Shape& shape, FileSource& files, ImageCache& images,
                        Diagnostics& diagnostics) {
  AreaEmitter emitter;
  emitter.shape = &shape;
  emitter.two_sided = reader.Bool("twosided", false);
  emitter.is_hidden = shape.surface.alpha.IsConstant() && shape.surface.alpha.constant <= 0;
  emitter.is_passed = (shape.surface.hidden_from & kHiddenFromIndirect) != 0;
  emitter.has_alpha = shape.surface.HasAlpha() && !emitter.is_hidden;
  if (reader.String("filename", "").empty()) {
    emitter.L = ReadEmission(reader, "L", files);
    return emitter;
  }
  if (reader.Has("L")) reader.FailAt("L", "an area light takes \"L\" or \"filename\", not both");
  emitter.image = RgbImage::Read(reader, images, diagnostics);
  emitter.image_scale = ReadImageScale(reader, emitter.image.color_space());
  emitter.L = Spectrum::Table(emitter.image.color_space().illuminant(), emitter.image_scale);
  return emitter;
}

using EmitterReader = AreaEmitter (*)(ParameterReader& reader, const Shape& shape, FileSource& files,
                                      ImageCache& images, Diagnostics& diagnostics);
constexpr Kind<EmitterReader> kAreaLights[] = {
    {"diffuse", Support::kSupported, ReadEmitter},
};
constexpr KindTable<EmitterReader> kAreaLightTable("area light", kAreaLights);

// The minimum of Dot(axis, p) over the box.
float SupportMin(const Bounds3& box, Vec3 axis) {
  float sum = 0;
  for (int i = 0; i < 3; ++i) sum += axis[i] * (axis[i] > 0 ? box.min[i] : box.max[i]);
  return sum;
}

}  // namespace

KindList AreaLightKinds() {
  return kAreaLightTable.List();
}

Result<void> AreaLights::Add(const EmittingShape& emitting, const Geometry& geometry, FileSource& files,
                             ImageCache& images, Diagnostics& diagnostics) {
  const Entity& entity = *emitting.description->area_light;
  const Shape& shape = ShapeOf(geometry, emitting.instance, emitting.shape);
  const Kind<EmitterReader>* kind = kAreaLightTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kAreaLightTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  SkipLinkParameters(reader);
  emitters_.push_back(kind->reader(reader, shape, files, images, diagnostics));
  AreaEmitter& emitter = emitters_.back();
  if (emitting.instance != Hit::kNoInstance) {
    emitter.render_from_shape = &geometry.motions[geometry.instances[emitting.instance].motion];
    emitter.times = geometry.times;
  }
  if (reader.failed()) return reader.Finish();
  const std::optional<float> power = ReadTotal(reader, "power");
  const float unit_exitance = MeanLuminance(emitter) * kPi * (emitter.two_sided ? 2.0f : 1.0f);
  if (power && !(unit_exitance > 0))
    reader.FailAt("power", "\"power\" cannot be reached: the image is black");
  if (const Result<void> finished = reader.Finish(); !finished) return finished.error();
  const uint32_t count = shape.PrimitiveCount();
  for (uint32_t i = 0; i < count; ++i) {
    AreaLight light{static_cast<uint32_t>(emitters_.size() - 1), i, 1};
    if (power) {
      const std::optional<float> area = AreaOf(emitter, i);
      if (!area) {
        return ErrorAt(entity.location,
                       "\"power\" of a curved shape that moves requires the same scale along all axes");
      }
      light.scale = *area > 0 ? *power / (unit_exitance * *area) : 0;
    }
    lights_.push_back(light);
  }
  if (CanJoin(emitter)) JoinRectangles(lights_.size() - count);
  return {};
}

// Among the lights from `first` on, which are the triangles of the last emitter.
void AreaLights::JoinRectangles(size_t first) {
  const auto& mesh = std::get<TriangleMesh>(emitters_.back().shape->form);
  for (size_t i = first; i + 1 < lights_.size(); ++i) {
    if (lights_[i].scale != lights_[i + 1].scale) continue;
    const std::optional<RectangleEmitter> rectangle = RectangleEmitter::Find(mesh, lights_[i].primitive);
    if (!rectangle) continue;
    lights_[i].rectangle = lights_[i + 1].rectangle = static_cast<uint32_t>(rectangles_.size());
    lights_[i + 1].is_second_half = true;
    rectangles_.push_back(*rectangle);
    ++i;
  }
}

std::optional<ShapeSample> AreaLights::SamplePoint(size_t light, const ReferencePoint& reference,
                                                   Point2 u) const {
  const AreaLight& area = lights_[light];
  const AreaEmitter& emitter = emitters_[area.emitter];
  if (area.IsInRectangle()) return rectangles_[area.rectangle].Sample(reference, u, emitter.two_sided);
  if (emitter.render_from_shape == nullptr)
    return SampleShape(*emitter.shape, area.primitive, reference, u, emitter.NeedsUv());
  const Transform render_from_shape = emitter.render_from_shape->At(reference.time);
  if (IsFlat(render_from_shape)) return std::nullopt;
  return SampleMovedShape(*emitter.shape, area.primitive, render_from_shape, reference, u);
}

float AreaLights::Pdf(size_t light, const ReferencePoint& reference, Vec3 wi,
                      const SurfaceInteraction& on_light) const {
  const AreaLight& area = lights_[light];
  const AreaEmitter& emitter = emitters_[area.emitter];
  if (area.IsInRectangle()) return rectangles_[area.rectangle].Pdf(reference, on_light.p);
  if (emitter.render_from_shape == nullptr)
    return ShapePdf(*emitter.shape, area.primitive, reference, wi, on_light);
  const Transform render_from_shape = emitter.render_from_shape->At(reference.time);
  if (IsFlat(render_from_shape)) return 0;
  return MovedShapePdf(*emitter.shape, area.primitive, render_from_shape, reference, wi, on_light);
}

std::optional<LightSample> AreaLights::Sample(size_t light, const ReferencePoint& reference, Point2 u,
                                              const SampledWavelengths& wavelengths,
                                              const TextureTable& textures) const {
  const AreaLight& area = lights_[light];
  const AreaEmitter& emitter = emitters_[area.emitter];
  const std::optional<ShapeSample> on_shape = SamplePoint(light, reference, u);
  if (!on_shape || !(on_shape->pdf > 0)) return std::nullopt;
  const Vec3 to_light = on_shape->p - reference.p;
  const float distance_squared = LengthSquared(to_light);
  if (!(distance_squared > 0)) return std::nullopt;
  const Vec3 wi = to_light / std::sqrt(distance_squared);
  if (!emitter.two_sided && Dot(on_shape->n, wi) >= 0) return std::nullopt;
  LightSample sample;
  sample.L = Emission(emitter, area, on_shape->uv, wavelengths);
  // Where alpha is below 1, only that share of rays would hit the emitter.
  if (emitter.has_alpha) {
    const TextureContext context{on_shape->p, on_shape->n, on_shape->uv, {}, {}, 0, 0, 0, 0};
    sample.L *= std::clamp(textures.Evaluate(emitter.shape->surface.alpha, context), 0.0f, 1.0f);
  }
  if (!AnyNonZero(sample.L)) return std::nullopt;
  sample.wi = wi;
  sample.pdf = on_shape->pdf;
  sample.p = on_shape->p;
  sample.p_error = on_shape->p_error;
  sample.n = on_shape->n;
  sample.is_delta = !emitter.IsHitByScatteredRays();
  return sample;
}

SampledSpectrum AreaLights::ImageEmission(const AreaEmitter& emitter, Point2 uv,
                                          const SampledWavelengths& wavelengths) {
  const Rgb rgb = emitter.image.Bilinear({uv.x, 1 - uv.y});
  const SampledSpectrum color =
      emitter.image.color_space().SampleFast(rgb, SpectrumUse::kIlluminant, wavelengths);
  return color * emitter.image_scale;
}

// `strength`: that of its emitter.
LightProfile AreaLights::ProfileOf(const AreaLight& light, float strength) const {
  if (light.is_second_half) return {false, 0, std::nullopt, 0};
  const AreaEmitter& emitter = emitters_[light.emitter];
  LightBounds bounds;
  bounds.box = BoundsOf(emitter, light.primitive);
  float area = StrengthArea(emitter, light.primitive);
  if (light.IsInRectangle()) {
    bounds.box = Union(bounds.box, BoundsOf(emitter, light.primitive + 1));
    area += StrengthArea(emitter, light.primitive + 1);
  }
  const NormalCone cone = NormalsOf(emitter, light.primitive);
  bounds.axis = cone.axis;
  bounds.cos_theta_o = cone.cos_angle;
  bounds.cos_theta_e = 0;
  bounds.strength = strength * std::abs(light.scale) * area;
  bounds.two_sided = emitter.two_sided;
  if (cone.cos_angle >= 1 && !emitter.two_sided) bounds.plane_min = SupportMin(bounds.box, cone.axis);
  return {true, bounds.strength * kPi * (emitter.two_sided ? 2.0f : 1.0f), bounds, 0};
}

void AreaLights::AddProfiles(std::vector<LightProfile>* profiles) const {
  uint32_t measured = UINT32_MAX;
  float strength = 0;  // of emitter `measured`
  for (const AreaLight& light : lights_) {
    if (light.emitter != measured) {
      strength = MeanStrength(emitters_[light.emitter]);
      measured = light.emitter;
    }
    profiles->push_back(ProfileOf(light, strength));
  }
}

}  // namespace tessera
