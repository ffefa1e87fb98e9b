#include "renderer/color/color_space.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "renderer/color/named_spectra.h"
#include "renderer/color/rgb_to_spectrum.h"
#include "renderer/color/srgb_table_data.h"

namespace tessera {
namespace {

using Matrix3f = std::array<std::array<float, 3>, 3>;

Matrix3f ToFloat(const Matrix3d& m) {
  Matrix3f result{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) result[i][j] = static_cast<float>(m[i][j]);
  }
  return result;
}

Vec3 Multiply(const Matrix3f& m, Vec3 v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

// Components in [0, 1]; what is not a number becomes 0.
Rgb ClampAlbedo(Rgb rgb) {
  return Min(Max(Rgb{0, 0, 0}, rgb), Rgb{1, 1, 1});
}
Rgb ClampNegative(Rgb rgb) {
  return Max(Rgb{0, 0, 0}, rgb);
}
// As pbrt compares: whether both coordinates are equal or nearly so.
bool IsClose(Point2 a, Chromaticity to) {
  constexpr float kTolerance = 1e-3f;
  const auto is_close = [](float v, float to) { return v == to || std::abs((v - to) / to) < kTolerance; };
  return is_close(a.x, static_cast<float>(to.x)) && is_close(a.y, static_cast<float>(to.y));
}
Chromaticity WhiteOf(const RgbPrimaries& primaries) {
  const std::array<double, 3> xyz = XyzOf(*NamedSpectrum(primaries.white));
  const double sum = xyz[0] + xyz[1] + xyz[2];
  return {xyz[0] / sum, xyz[1] / sum};
}

bool IsGrey(Rgb rgb) {
  return rgb.x == rgb.y && rgb.y == rgb.z;
}

}  // namespace

// Fills in the members that are constant afterwards.
struct ColorSpaceMaker {
  static ColorSpace Make(const RgbPrimaries& primaries, const float* table) {
    const Matrix3d xyz_from_rgb = XyzFromRgb(primaries);
    ColorSpace space;
    space.name_ = primaries.name;
    space.illuminant_ = NamedSpectrum(primaries.white);
    space.xyz_from_rgb_ = ToFloat(xyz_from_rgb);
    space.rgb_from_xyz_ = ToFloat(Inverse(xyz_from_rgb));
    space.rgb_to_spectrum_ = std::make_shared<const RgbToSpectrum>(primaries, table);
    return space;
  }
};

const ColorSpace& ColorSpace::Srgb() {
  static const ColorSpace space = ColorSpaceMaker::Make(kSrgbPrimaries, SrgbTable());
  return space;
}

const ColorSpace* ColorSpace::Named(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower == kSrgbPrimaries.name) return &Srgb();
  static const ColorSpace others[] = {ColorSpaceMaker::Make(kDciP3Primaries, nullptr),
                                      ColorSpaceMaker::Make(kRec2020Primaries, nullptr),
                                      ColorSpaceMaker::Make(kAcesPrimaries, nullptr)};
  for (const ColorSpace& space : others) {
    if (lower == space.name()) return &space;
  }
  return nullptr;
}

const ColorSpace* ColorSpace::Matching(Point2 red, Point2 green, Point2 blue, Point2 white) {
  for (const RgbPrimaries* primaries :
       {&kSrgbPrimaries, &kDciP3Primaries, &kRec2020Primaries, &kAcesPrimaries}) {
    if (IsClose(red, primaries->red) && IsClose(green, primaries->green) && IsClose(blue, primaries->blue) &&
        IsClose(white, WhiteOf(*primaries))) {
      return Named(primaries->name);
    }
  }
  return nullptr;
}

Rgb ColorSpace::FromXyz(Vec3 xyz) const {
  return Multiply(rgb_from_xyz_, xyz);
}
Vec3 ColorSpace::ToXyz(Rgb rgb) const {
  return Multiply(xyz_from_rgb_, rgb);
}

SigmoidPolynomial ColorSpace::AlbedoPolynomial(Rgb rgb) const {
  return rgb_to_spectrum_->Solve(ClampAlbedo(rgb));
}
SigmoidPolynomial ColorSpace::AlbedoPolynomialFast(Rgb rgb) const {
  return rgb_to_spectrum_->LookUp(ClampAlbedo(rgb));
}

Spectrum ColorSpace::ToSpectrum(Rgb rgb, SpectrumUse use) const {
  const auto polynomial = [this](Rgb albedo) {
    return rgb_to_spectrum_->HasTable() ? AlbedoPolynomialFast(albedo) : AlbedoPolynomial(albedo);
  };
  if (use == SpectrumUse::kAlbedo) {
    rgb = ClampAlbedo(rgb);
    return IsGrey(rgb) ? Spectrum::Constant(rgb.x) : Spectrum::Sigmoid(polynomial(rgb), 1);
  }
  rgb = ClampNegative(rgb);
  if (use == SpectrumUse::kUnbounded && IsGrey(rgb)) return Spectrum::Constant(rgb.x);
  // Half the largest component is where polynomials are smoothest.
  const float scale = 2 * MaxComponent(rgb);
  const SigmoidPolynomial shape = scale > 0 ? polynomial(rgb / scale) : SigmoidPolynomial{};
  return use == SpectrumUse::kUnbounded ? Spectrum::Sigmoid(shape, scale)
                                        : Spectrum::SigmoidTimesTable(shape, illuminant_, scale);
}

SampledSpectrum ColorSpace::SampleFast(Rgb rgb, SpectrumUse use,
                                       const SampledWavelengths& wavelengths) const {
  rgb = use == SpectrumUse::kAlbedo ? ClampAlbedo(rgb) : ClampNegative(rgb);
  SampledSpectrum value(rgb.x);
  if (!IsGrey(rgb)) {
    const float scale = use == SpectrumUse::kAlbedo ? 1 : 2 * MaxComponent(rgb);
    value = AlbedoPolynomialFast(rgb * (1 / scale)).Sample(wavelengths) * scale;
  }
  return use == SpectrumUse::kIlluminant ? value * SampleTable(*illuminant_, wavelengths) : value;
}

}  // namespace tessera
