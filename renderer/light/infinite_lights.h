// Light from all around, infinitely far away.
#pragma once

#include "renderer/color/spectrum.h"
#include "renderer/light/emission_image.h"
#include "renderer/light/light_kind.h"
#include "renderer/math/distribution.h"
#include "renderer/math/sampling.h"

namespace tessera {

// The same radiance from every direction. Only rays that leave the scene find it, unless LightContext::
// samples_all: where all directions are alike, light sampling does no better than sampling the surface.
struct ConstantInfiniteLight {
  Spectrum L;
  bool is_sampled = false;

  static ConstantInfiniteLight Read(ParameterReader& reader, const LightContext& context);
  std::optional<LightSample> Sample(const LightQuery& query) const;
  LightProfile Profile(float scene_radius) const;
  SampledSpectrum Radiance(Point3, Vec3, const SampledWavelengths& wavelengths) const {
    return L.Sample(wavelengths);
  }
  float Pdf(Point3, Vec3) const { return is_sampled ? kInv4Pi : 0; }
};

// Radiance from a square equal-area octahedral picture (math/equal_area.h), z up; each texel is constant.
struct ImageInfiniteLight {
  Transform render_from_light, light_from_render;
  bool keeps_angles = true;  // render_from_light
  EmissionMap map;
  // Of what exceeds the mean. What is below it is found by rays that leave the scene (Karlik et al. 2019).
  // With LightContext::samples_all, of everything.
  Distribution2D brighter;
  float mean_strength = 0;     // of the whole picture
  float sampled_strength = 0;  // of `brighter`

  // Expects parameter `filename`.
  static ImageInfiniteLight Read(ParameterReader& reader, const LightContext& context);
  SampledSpectrum Radiance(Point3, Vec3 d, const SampledWavelengths& wavelengths) const;
  std::optional<LightSample> Sample(const LightQuery& query) const;
  float Pdf(Point3, Vec3 wi) const;
  LightProfile Profile(float scene_radius) const;

 private:
  Point2 PlaceInMap(Vec3 d) const;
  // The density of unit direction wi in rendering space per that of its place in the map.
  float DensityRatio(Vec3 wi) const;
};

}  // namespace tessera
