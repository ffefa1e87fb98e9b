// From radiance at four wavelengths to the linear RGB of the output.
#pragma once

#include <limits>

#include "renderer/color/color_space.h"
#include "renderer/color/named_spectra.h"
#include "renderer/color/wavelengths.h"

namespace tessera {

// The CIE 1931 observer as sensor (pbrt's "cie1931"), with exposure, white balance and clamp. Immutable.
class FilmSensor {
 public:
  // `imaging_ratio` = exposure time x ISO / 100. `white_balance` in kelvin, 0 for none. `component_max`
  // bounds a sample's largest sensor component. The colour space must outlive the sensor.
  FilmSensor(const ColorSpace& color_space, float imaging_ratio, float white_balance, float component_max);

  // The output RGB of one sample of radiance. Divides by the densities of its wavelengths.
  Rgb ToRgb(SampledSpectrum radiance, const SampledWavelengths& wavelengths) const {
    Vec3 xyz = ToXyz(radiance, wavelengths) * imaging_ratio_;
    const float largest = MaxComponent(xyz);
    if (largest > component_max_) xyz = xyz * (component_max_ / largest);
    return {output_[0][0] * xyz.x + output_[0][1] * xyz.y + output_[0][2] * xyz.z,
            output_[1][0] * xyz.x + output_[1][1] * xyz.y + output_[1][2] * xyz.z,
            output_[2][0] * xyz.x + output_[2][1] * xyz.y + output_[2][2] * xyz.z};
  }

  // The RGB of one sample of a reflectance under the white of the output colour space: in the mean (1, 1, 1)
  // for a reflectance of 1. Divides by the densities of the wavelengths.
  Rgb ReflectanceToRgb(SampledSpectrum reflectance, const SampledWavelengths& wavelengths) const;

 private:
  // CIE 1931 XYZ.
  Vec3 ToXyz(SampledSpectrum radiance, const SampledWavelengths& wavelengths) const {
    const SampledSpectrum weighted = SafeDiv(radiance, wavelengths.pdf);
    return {Average(SampleTable(*x_, wavelengths) * weighted),
            Average(SampleTable(*y_, wavelengths) * weighted),
            Average(SampleTable(*z_, wavelengths) * weighted)};
  }

  const ColorSpace* color_space_;
  float white_scale_;  // gives the illuminant of the colour space Y = 1
  const DenseTable *x_, *y_, *z_;
  float imaging_ratio_, component_max_;
  std::array<std::array<float, 3>, 3> output_;  // RGB from sensor XYZ
};

}  // namespace tessera
