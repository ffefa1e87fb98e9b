// Lights without extent: a point, a direction, or an intensity that varies with direction.
#pragma once

#include <optional>

#include "renderer/color/spectrum.h"
#include "renderer/light/light_kind.h"

namespace tessera {

// Position and orientation of a light without extent.
struct LightPlace {
  Point3 p;
  Transform light_from_render;
  bool keeps_angles;  // if not, cones of the light's space are no cones in rendering space

  explicit LightPlace(const Transform& render_from_light)
      : p(render_from_light.ToPoint({})),
        light_from_render(render_from_light.Inverse()),
        keeps_angles(render_from_light.KeepsAngles()) {}
  // The unit direction, in the light's space, in which light leaves towards wi's origin.
  Vec3 Outgoing(Vec3 wi) const { return Normalize(light_from_render.ToVector(-wi)); }
};

// The sample of a light at `p` towards `reference`, with L = 1 / distance^2. Returns nullopt at the light
// itself.
std::optional<LightSample> SamplePoint(Point3 p, const ReferencePoint& reference);

// Emits the same in all directions.
struct PointLight {
  Point3 p;
  Spectrum I;  // radiant intensity

  static PointLight Read(ParameterReader& reader, const LightContext& context);
  std::optional<LightSample> Sample(const LightQuery& query) const;
  LightProfile Profile(float scene_radius) const;
};

// A cone about +z of its space, fading towards the rim.
struct SpotLight {
  LightPlace place;
  Vec3 axis;   // in rendering space
  Spectrum I;  // on the axis
  float cos_falloff_start = 1, cos_falloff_end = 1;

  static SpotLight Read(ParameterReader& reader, const LightContext& context);
  std::optional<LightSample> Sample(const LightQuery& query) const;
  // The share of I at an angle to the axis.
  float Falloff(float cos_theta) const;
  // Total power of a light with I = 1.
  float UnitPower() const;
  LightProfile Profile(float scene_radius) const;
};

// Arrives from the same direction everywhere.
struct DistantLight {
  Vec3 wi;     // unit, towards the light
  Spectrum L;  // irradiance on a plane that faces it

  static DistantLight Read(ParameterReader& reader, const LightContext& context);
  std::optional<LightSample> Sample(const LightQuery& query) const;
  LightProfile Profile(float scene_radius) const;
};

}  // namespace tessera
