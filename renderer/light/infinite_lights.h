// Light from all around, infinitely far away.
#pragma once

#include "renderer/color/spectrum.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/light/emission_image.h"
#include "renderer/light/light.h"
#include "renderer/light/light_chooser.h"
#include "renderer/math/distribution.h"

namespace tessera {

// The same radiance from every direction. Found by rays that miss only: no light sampling does better than
// sampling the surface where all directions are alike.
struct ConstantInfiniteLight {
  Spectrum L;

  static ConstantInfiniteLight Read(ParameterReader& reader, FileSource& files);
};

// Radiance from a square equal-area octahedral picture (math/equal_area.h), z up; each texel is constant.
struct ImageInfiniteLight {
  Transform render_from_light, light_from_render;
  EmissionMap map;
  // Of what exceeds the mean: what is below it is left to rays that miss (Karlik et al. 2019).
  Distribution2D brighter;
  float mean_strength = 0;     // of the whole picture
  float sampled_strength = 0;  // of `brighter`

  // Expects parameter `filename`.
  static ImageInfiniteLight Read(ParameterReader& reader, const Transform& render_from_light,
                                 ImageCache& images);
  SampledSpectrum Radiance(Vec3 d, const SampledWavelengths& wavelengths) const;
  std::optional<LightSample> Sample(const ReferencePoint& reference, Point2 u, float scene_radius,
                                    const SampledWavelengths& wavelengths) const;
  float Pdf(Vec3 wi) const;
  LightProfile Profile(float scene_radius) const;

 private:
  Point2 PlaceInMap(Vec3 d) const;
};

}  // namespace tessera
