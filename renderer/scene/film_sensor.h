// From radiance at four wavelengths to the linear RGB of the output.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string_view>

#include "renderer/color/color_space.h"
#include "renderer/color/named_spectra.h"
#include "renderer/color/wavelengths.h"
#include "renderer/math/matrix3.h"

namespace tessera {

struct FilmExposure {
  float imaging_ratio = 1;  // exposure time x ISO / 100
  // Bounds the largest sensor component of one sample.
  float component_max = std::numeric_limits<float>::infinity();
};

// The spectral sensitivities of a film, with exposure, white balance and clamp. Immutable.
class FilmSensor {
 public:
  // The CIE 1931 observer (pbrt's "cie1931"). `white_balance` is the temperature of the daylight that becomes
  // the white of the picture, in kelvin, 0 for none. The colour space must outlive the sensor.
  static FilmSensor Observer(const ColorSpace& color_space, const FilmExposure& exposure,
                             float white_balance);
  // A camera of SensorNames(), for a daylight of 6500 K if `white_balance` is 0. Returns nullopt if there is
  // no such camera.
  static std::optional<FilmSensor> Measured(std::string_view name, const ColorSpace& color_space,
                                            const FilmExposure& exposure, float white_balance);

  // The output RGB of one sample of radiance. Divides by the densities of its wavelengths.
  Rgb ToRgb(SampledSpectrum radiance, const SampledWavelengths& wavelengths) const {
    Vec3 seen = Respond(responses_, radiance, wavelengths) * exposure_.imaging_ratio;
    const float largest = MaxComponent(seen);
    if (largest > exposure_.component_max) seen = seen * (exposure_.component_max / largest);
    return {output_[0][0] * seen.x + output_[0][1] * seen.y + output_[0][2] * seen.z,
            output_[1][0] * seen.x + output_[1][1] * seen.y + output_[1][2] * seen.z,
            output_[2][0] * seen.x + output_[2][1] * seen.y + output_[2][2] * seen.z};
  }

  // What the clamp multiplies a sample by: 1 unless it is too bright.
  float Limit(SampledSpectrum radiance, const SampledWavelengths& wavelengths) const {
    const float largest = MaxComponent(Respond(responses_, radiance, wavelengths) * exposure_.imaging_ratio);
    return largest > exposure_.component_max ? exposure_.component_max / largest : 1;
  }
  // The output RGB of a part of a sample with this limit.
  Rgb ToRgb(SampledSpectrum part, const SampledWavelengths& wavelengths, float limit) const {
    return Multiply(output_, Respond(responses_, part, wavelengths) * exposure_.imaging_ratio * limit);
  }

  // The RGB of one sample of a reflectance under the white of the output colour space: in the mean (1, 1, 1)
  // for a reflectance of 1. Divides by the densities of the wavelengths.
  Rgb ReflectanceToRgb(SampledSpectrum reflectance, const SampledWavelengths& wavelengths) const;

 private:
  using Responses = std::array<const DenseTable*, 3>;

  FilmSensor(const ColorSpace& color_space, const FilmExposure& exposure);

  static Vec3 Respond(const Responses& responses, SampledSpectrum radiance,
                      const SampledWavelengths& wavelengths) {
    const SampledSpectrum weighted = SafeDiv(radiance, wavelengths.pdf);
    return {Average(SampleTable(*responses[0], wavelengths) * weighted),
            Average(SampleTable(*responses[1], wavelengths) * weighted),
            Average(SampleTable(*responses[2], wavelengths) * weighted)};
  }

  const ColorSpace* color_space_;
  float white_scale_;    // gives the illuminant of the colour space Y = 1
  Responses responses_;  // CIE XYZ, or red, green and blue
  FilmExposure exposure_;
  Matrix3 output_;  // RGB from the components of the sensor
};

}  // namespace tessera
