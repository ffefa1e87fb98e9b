// RGB colour spaces: primaries and white point, and the way from RGB to spectra and from XYZ to RGB.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "renderer/color/spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

class RgbToSpectrum;  // rgb_to_spectrum.h

// A linear RGB triple.
using Rgb = Vec3;

// Immutable; the four that exist live for the whole program (they are constants of nature, built on first
// use).
class ColorSpace {
 public:
  static const ColorSpace& Srgb();
  // "srgb", "dci-p3", "rec2020", "aces2065-1" in any case; nullptr for any other name.
  static const ColorSpace* Named(std::string_view name);

  // The one with these primaries and this white point (CIE xy), to one part in a thousand; nullptr if there
  // is none.
  static const ColorSpace* Matching(Point2 red, Point2 green, Point2 blue, Point2 white);

  std::string_view name() const { return name_; }
  // The white point's spectrum, as dense table, with the luminance integral kCieYIntegral: its Y is 1.
  const std::shared_ptr<const DenseTable>& illuminant() const { return illuminant_; }
  Rgb FromXyz(Vec3 xyz) const;
  Vec3 ToXyz(Rgb rgb) const;
  const std::array<std::array<float, 3>, 3>& rgb_from_xyz() const { return rgb_from_xyz_; }

  // The smooth spectrum of an albedo; components are clamped to [0, 1].
  SigmoidPolynomial AlbedoPolynomial(Rgb rgb) const;
  // The same by interpolation in a table, fast enough for every texture lookup.
  SigmoidPolynomial AlbedoPolynomialFast(Rgb rgb) const;
  // An RGB triple as a spectrum of the given use; sRGB by the table, so that a constant and a texture of the
  // same colour, and pbrt, agree; other spaces exactly, because their tables are only built when a texture
  // needs them.
  Spectrum ToSpectrum(Rgb rgb, SpectrumUse use) const;
  // The same for texture lookups, evaluated immediately.
  SampledSpectrum SampleFast(Rgb rgb, SpectrumUse use, const SampledWavelengths& wavelengths) const;

 private:
  friend struct ColorSpaceMaker;
  ColorSpace() = default;
  std::string_view name_;
  std::shared_ptr<const DenseTable> illuminant_;
  std::array<std::array<float, 3>, 3> rgb_from_xyz_{}, xyz_from_rgb_{};
  std::shared_ptr<const RgbToSpectrum> rgb_to_spectrum_;
};

}  // namespace tessera
