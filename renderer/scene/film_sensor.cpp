#include "renderer/scene/film_sensor.h"

namespace tessera {
namespace {

using Matrix3 = std::array<std::array<float, 3>, 3>;

Matrix3 Multiply(const Matrix3& a, const Matrix3& b) {
  Matrix3 r{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return r;
}

Vec3 Multiply(const Matrix3& m, Vec3 v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

// Bradford cone responses (ICC.1:2010, annex E) and their inverse.
constexpr Matrix3 kConesFromXyz{
    {{0.8951f, 0.2664f, -0.1614f}, {-0.7502f, 1.7135f, 0.0367f}, {0.0389f, -0.0685f, 1.0296f}}};
constexpr Matrix3 kXyzFromCones{{{0.9869929f, -0.1470543f, 0.1599627f},
                                 {0.4323053f, 0.5183603f, 0.0492912f},
                                 {-0.0085287f, 0.0400428f, 0.9684867f}}};

// The Y of a spectrum.
float Luminance(const DenseTable& spectrum) {
  double y = 0;
  for (int i = 0; i < kLambdaCount; ++i) y += static_cast<double>(CieY()[i]) * spectrum[i];
  return static_cast<float>(y);
}

// XYZ of a spectrum, scaled to Y = 1.
Vec3 WhitePoint(const DenseTable& spectrum) {
  double x = 0, y = 0, z = 0;
  for (int i = 0; i < kLambdaCount; ++i) {
    x += static_cast<double>(CieX()[i]) * spectrum[i];
    y += static_cast<double>(CieY()[i]) * spectrum[i];
    z += static_cast<double>(CieZ()[i]) * spectrum[i];
  }
  return {static_cast<float>(x / y), 1, static_cast<float>(z / y)};
}

// Von Kries adaptation from one white to another.
Matrix3 WhiteBalance(Vec3 from, Vec3 to) {
  const Vec3 a = Multiply(kConesFromXyz, from);
  const Vec3 b = Multiply(kConesFromXyz, to);
  const Matrix3 scale{{{b.x / a.x, 0, 0}, {0, b.y / a.y, 0}, {0, 0, b.z / a.z}}};
  return Multiply(kXyzFromCones, Multiply(scale, kConesFromXyz));
}

}  // namespace

FilmSensor::FilmSensor(const ColorSpace& color_space, float imaging_ratio, float white_balance,
                       float component_max)
    : color_space_(&color_space),
      white_scale_(1 / Luminance(*color_space.illuminant())),
      x_(&CieX()),
      y_(&CieY()),
      z_(&CieZ()),
      imaging_ratio_(imaging_ratio),
      component_max_(component_max),
      output_(color_space.rgb_from_xyz()) {
  if (white_balance > 0) {
    const Vec3 from = WhitePoint(*DaylightIlluminant(white_balance));
    output_ = Multiply(output_, WhiteBalance(from, WhitePoint(*color_space.illuminant())));
  }
}

Rgb FilmSensor::ReflectanceToRgb(SampledSpectrum reflectance, const SampledWavelengths& wavelengths) const {
  const SampledSpectrum white = SampleTable(*color_space_->illuminant(), wavelengths) * white_scale_;
  const Vec3 rgb = Multiply(color_space_->rgb_from_xyz(), ToXyz(reflectance * white, wavelengths));
  return {rgb.x, rgb.y, rgb.z};
}

}  // namespace tessera
