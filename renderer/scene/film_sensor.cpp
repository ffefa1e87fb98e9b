#include "renderer/scene/film_sensor.h"

#include <string>

#include "renderer/scene/sensor_matrix.h"

namespace tessera {
namespace {

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

FilmSensor::FilmSensor(const ColorSpace& color_space, const FilmExposure& exposure)
    : color_space_(&color_space),
      white_scale_(1 / Luminance(*color_space.illuminant())),
      responses_{&CieX(), &CieY(), &CieZ()},
      exposure_(exposure),
      output_(color_space.rgb_from_xyz()) {}

FilmSensor FilmSensor::Observer(const ColorSpace& color_space, const FilmExposure& exposure,
                                float white_balance) {
  FilmSensor sensor(color_space, exposure);
  if (white_balance > 0) {
    const Vec3 from = WhitePoint(*DaylightIlluminant(white_balance));
    sensor.output_ = Multiply(sensor.output_, WhiteBalance(from, WhitePoint(*color_space.illuminant())));
  }
  return sensor;
}

std::optional<FilmSensor> FilmSensor::Measured(std::string_view name, const ColorSpace& color_space,
                                               const FilmExposure& exposure, float white_balance) {
  FilmSensor sensor(color_space, exposure);
  const char* const suffixes[] = {"_r", "_g", "_b"};
  for (size_t i = 0; i < sensor.responses_.size(); ++i) {
    const std::shared_ptr<const DenseTable> response = NamedSpectrum(std::string(name) + suffixes[i]);
    if (!response) return std::nullopt;
    sensor.responses_[i] = response.get();  // lives for the whole program
  }
  constexpr float kDaylight = 6500;  // kelvin
  const auto illuminant = DaylightIlluminant(white_balance > 0 ? white_balance : kDaylight);
  sensor.output_ =
      Multiply(sensor.output_, XyzFromSensor(sensor.responses_, *illuminant, *color_space.illuminant()));
  return sensor;
}

Rgb FilmSensor::ReflectanceToRgb(SampledSpectrum reflectance, const SampledWavelengths& wavelengths) const {
  const SampledSpectrum white = SampleTable(*color_space_->illuminant(), wavelengths) * white_scale_;
  const Vec3 rgb = Multiply(color_space_->rgb_from_xyz(),
                            Respond({&CieX(), &CieY(), &CieZ()}, reflectance * white, wavelengths));
  return {rgb.x, rgb.y, rgb.z};
}

}  // namespace tessera
