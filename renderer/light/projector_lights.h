// Point lights whose intensity over directions is given by a file.
#pragma once

#include <vector>

#include "renderer/light/delta_lights.h"
#include "renderer/light/emission_image.h"
#include "renderer/light/ies_profile.h"

namespace tessera {

// Intensity from a square equal-area octahedral map of one channel (math/equal_area.h) or from photometry, y
// up.
struct GoniometricLight {
  LightPlace place;
  Spectrum I;
  std::vector<float> map;  // size x size factors of I, if there is no profile
  int size = 0;
  IesProfile profile;
  float mean = 0;  // of the factors, over all directions

  static GoniometricLight Read(ParameterReader& reader, const LightContext& context);
  std::optional<LightSample> Sample(const LightQuery& query) const;
  LightProfile Profile(float scene_radius) const;

 private:
  // Of I along the unit direction d in the light's space.
  float Factor(Vec3 d) const;
};

// A slide projector that looks along +z of its space.
struct ProjectionLight {
  LightPlace place;
  Vec3 axis;  // in rendering space
  EmissionMap map;
  float tan_half_fov = 1;         // of the shorter side
  float width = 1, height = 1;    // half sizes of the picture, the shorter one is 1
  float power = 0, strength = 0;  // for choosing between lights

  static ProjectionLight Read(ParameterReader& reader, const LightContext& context);
  std::optional<LightSample> Sample(const LightQuery& query) const;
  LightProfile Profile(float scene_radius) const;

 private:
  // The mean over the picture of `value(x, y)` times cos^3: solid angle per area of the plane at distance 1.
  template <typename Value>
  float SolidAngleMean(int width_px, int height_px, const Value& value) const;
  // Area of the picture on the plane at distance 1.
  float PlaneArea() const { return 4 * Sqr(tan_half_fov) * width * height; }
};

}  // namespace tessera
