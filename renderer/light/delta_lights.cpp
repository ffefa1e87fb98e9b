#include "renderer/light/delta_lights.h"

#include "renderer/light/emission.h"

namespace tessera {
namespace {

float SmoothStep(float x, float a, float b) {
  if (a == b) return x < a ? 0.0f : 1.0f;
  const float t = std::clamp((x - a) / (b - a), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

Bounds3 BoxOf(Point3 p) {
  return {p, p};
}

// A transform whose z axis is the unit vector z, from the frame to its parent.
Transform FrameTransform(const Frame& frame) {
  Matrix4 m, inverse;
  const Vec3 axes[3] = {frame.x, frame.y, frame.z};
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      m.m[row][column] = axes[column][row];
      inverse.m[column][row] = axes[column][row];
    }
  }
  return {m, inverse};
}

// The unit vector between two parameters that must differ.
Vec3 ReadDirection(ParameterReader& reader, Point3* from) {
  *from = reader.Point3Value("from", {0, 0, 0});
  const Point3 to = reader.Point3Value("to", {0, 0, 1});
  const Vec3 direction = to - *from;
  if (Length(direction) > 0 && std::isfinite(Length(direction))) return Normalize(direction);
  reader.FailAt("to", "\"from\" and \"to\" must be different points");
  return {0, 0, 1};
}

}  // namespace

std::optional<LightSample> SamplePoint(Point3 p, const ReferencePoint& reference) {
  const Vec3 to_light = p - reference.p;
  const float distance_squared = LengthSquared(to_light);
  if (!(distance_squared > 0)) return std::nullopt;
  LightSample sample;
  sample.L = SampledSpectrum(1 / distance_squared);
  sample.wi = to_light / std::sqrt(distance_squared);
  sample.pdf = 1;
  sample.p = p;
  sample.is_delta = true;
  return sample;
}

PointLight PointLight::Read(ParameterReader& reader, const LightContext& context) {
  PointLight light;
  light.I = ReadEmission(reader, "I", context.files);
  light.p = context.render_from_light.ToPoint(reader.Point3Value("from", {0, 0, 0}));
  if (const auto power = ReadTotal(reader, "power")) light.I = light.I.Scaled(*power * kInv4Pi);
  return light;
}

std::optional<LightSample> PointLight::Sample(const LightQuery& query) const {
  std::optional<LightSample> sample = SamplePoint(p, query.reference);
  if (sample) sample->L *= I.Sample(query.wavelengths);
  return sample;
}

LightProfile PointLight::Profile(float) const {
  const float strength = Strength(I);
  LightBounds bounds;
  bounds.box = BoxOf(p);
  bounds.AddAllDirections();
  bounds.strength = strength;
  return {true, 4 * kPi * strength, bounds, 0};
}

SpotLight SpotLight::Read(ParameterReader& reader, const LightContext& context) {
  Point3 from;
  const Vec3 direction = ReadDirection(reader, &from);
  const Transform from_spot =
      context.render_from_light * Translate(from) * FrameTransform(Frame::FromZ(direction));
  const float angle = reader.Float("coneangle", 30), delta = reader.Float("conedeltaangle", 5);
  if (delta < 0) reader.FailAt("conedeltaangle", "\"conedeltaangle\" must not be negative");
  SpotLight light{LightPlace(from_spot), Normalize(from_spot.ToVector({0, 0, 1})),
                  ReadEmission(reader, "I", context.files), std::cos(Radians(angle - delta)),
                  std::cos(Radians(angle))};
  if (const auto power = ReadTotal(reader, "power")) {
    if (!(light.UnitPower() > 0))
      reader.FailAt("power", "\"power\" requires a cone angle above 0");
    else
      light.I = light.I.Scaled(*power / light.UnitPower());
  }
  return light;
}

float SpotLight::Falloff(float cos_theta) const {
  return SmoothStep(cos_theta, cos_falloff_end, cos_falloff_start);
}

float SpotLight::UnitPower() const {
  return 2 * kPi * ((1 - cos_falloff_start) + (cos_falloff_start - cos_falloff_end) / 2);
}

std::optional<LightSample> SpotLight::Sample(const LightQuery& query) const {
  std::optional<LightSample> sample = SamplePoint(place.p, query.reference);
  if (!sample) return std::nullopt;
  const float falloff = Falloff(place.Outgoing(sample->wi).z);
  if (falloff == 0) return std::nullopt;
  sample->L *= falloff * I.Sample(query.wavelengths);
  return sample;
}

LightProfile SpotLight::Profile(float) const {
  // Against rounding at the rim, where only samples of this light find it.
  constexpr float kRimSlack = 1e-3f;
  const float fade = std::acos(cos_falloff_end) - std::acos(cos_falloff_start);
  LightBounds bounds;
  bounds.box = BoxOf(place.p);
  bounds.axis = axis;
  bounds.cos_theta_o = cos_falloff_start;
  bounds.cos_theta_e = std::cos(fade) - kRimSlack;
  // The falloff of a delta above the cone angle may leave out the axis and light everything else.
  const bool is_cone = place.keeps_angles && cos_falloff_start >= cos_falloff_end;
  if (!is_cone || bounds.cos_theta_e < 0) bounds.AddAllDirections();
  bounds.strength = Strength(I);
  return {true, bounds.strength * UnitPower(), bounds, 0};
}

DistantLight DistantLight::Read(ParameterReader& reader, const LightContext& context) {
  Point3 from;
  const Vec3 direction = ReadDirection(reader, &from);
  DistantLight light;
  light.wi = Normalize(context.render_from_light.ToVector(-direction));
  light.L = ReadEmission(reader, "L", context.files);
  if (const auto illuminance = ReadTotal(reader, "illuminance")) light.L = light.L.Scaled(*illuminance);
  return light;
}

std::optional<LightSample> DistantLight::Sample(const LightQuery& query) const {
  LightSample sample;
  sample.L = L.Sample(query.wavelengths);
  sample.wi = wi;
  sample.pdf = 1;
  sample.p = query.reference.p + wi * (2 * query.scene_radius);
  sample.is_delta = true;
  return sample;
}

LightProfile DistantLight::Profile(float scene_radius) const {
  return {true, Strength(L) * kPi * Sqr(scene_radius), std::nullopt, Strength(L)};
}

}  // namespace tessera
