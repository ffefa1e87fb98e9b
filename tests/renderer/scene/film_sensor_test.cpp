#include "renderer/scene/film_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera::film_sensor {
namespace {

// What the sensor sees of a reflectance under an illuminant of luminance 1: the mean over all wavelengths.
Rgb Seen(const FilmSensor& sensor, const DenseTable& illuminant, const DenseTable* reflectance) {
  constexpr int kSamples = 2000;
  Rgb sum;
  double luminance = 0;
  for (size_t i = 0; i < illuminant.size(); ++i)
    luminance += static_cast<double>(illuminant[i]) * static_cast<double>(CieY()[i]);
  for (int i = 0; i < kSamples; ++i) {
    const auto wavelengths = SampledWavelengths::SampleVisible((static_cast<float>(i) + 0.5f) / kSamples);
    SampledSpectrum light = SampleTable(illuminant, wavelengths) / static_cast<float>(luminance);
    if (reflectance != nullptr) light = light * SampleTable(*reflectance, wavelengths);
    sum = sum + sensor.ToRgb(light, wavelengths) / static_cast<float>(kSamples);
  }
  return sum;
}

Rgb White(const FilmSensor& sensor, const DenseTable& illuminant) {
  return Seen(sensor, illuminant, nullptr);
}

// A sensor by its name in scenes.
FilmSensor Sensor(std::string_view name, float white_balance = 0, const FilmExposure& exposure = {}) {
  const ColorSpace& srgb = ColorSpace::Srgb();
  if (name == "cie1931") return FilmSensor::Observer(srgb, exposure, white_balance);
  const auto sensor = FilmSensor::Measured(name, srgb, exposure, white_balance);
  EXPECT_TRUE(sensor) << name;
  return *sensor;
}

std::vector<std::string_view> AllSensors() {
  std::vector<std::string_view> names{"cie1931"};
  names.insert(names.end(), SensorNames().begin(), SensorNames().end());
  return names;
}

float Encoded(float v) {
  v = std::clamp(v, 0.0f, 1.0f);
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

TEST(FilmSensor, TheObserverSeesTheWhiteOfTheColourSpaceAsWhite) {
  for (const char* name : {"srgb", "dci-p3", "rec2020", "aces2065-1"}) {
    const ColorSpace& space = *ColorSpace::Named(name);
    const Rgb white = White(FilmSensor::Observer(space, {}, 0), *space.illuminant());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1, 0.01f) << name;
  }
}

// What the four wavelengths of a path miss of white is the noise that a grey picture without any other has.
TEST(FilmSensor, FourWavelengthsSeeWhiteAlmostWithoutColourNoise) {
  const ColorSpace& srgb = ColorSpace::Srgb();
  const FilmSensor sensor = FilmSensor::Observer(srgb, {}, 0);
  double luminance = 0;
  for (size_t i = 0; i < srgb.illuminant()->size(); ++i)
    luminance += static_cast<double>((*srgb.illuminant())[i]) * static_cast<double>(CieY()[i]);
  constexpr int kSamples = 1000;
  std::array<double, 3> squares{};
  for (int i = 0; i < kSamples; ++i) {
    const auto wavelengths = SampledWavelengths::SampleVisible((static_cast<float>(i) + 0.5f) / kSamples);
    const Rgb seen = sensor.ToRgb(
        SampleTable(*srgb.illuminant(), wavelengths) / static_cast<float>(luminance), wavelengths);
    for (int c = 0; c < 3; ++c) {
      const double error = static_cast<double>(seen[c]) - 1;
      squares[static_cast<size_t>(c)] += error * error;
    }
  }
  for (const double sum : squares) EXPECT_LT(std::sqrt(sum / kSamples), 0.06);
}

TEST(FilmSensor, WhiteBalanceMakesItsDaylightWhite) {
  for (const std::string_view name : AllSensors()) {
    for (const float kelvin : {4500.0f, 6500.0f, 9000.0f}) {
      const Rgb white = White(Sensor(name, kelvin), *DaylightIlluminant(kelvin));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1, 0.05f) << name << " " << kelvin;
      // Bluer light than the sensor is balanced for looks blue, warmer light red.
      const Rgb blue = White(Sensor(name, kelvin), *DaylightIlluminant(2 * kelvin));
      const Rgb red = White(Sensor(name, kelvin), *DaylightIlluminant(kelvin / 1.5f));
      EXPECT_GT(blue.z, 1.15f * blue.x) << name;
      EXPECT_GT(red.x, 1.15f * red.z) << name;
    }
  }
}

TEST(FilmSensor, MeasuredSensorsAreBalancedForDaylightWithoutAWhiteBalance) {
  for (const std::string_view name : SensorNames()) {
    const Rgb given = White(Sensor(name, 6500), *DaylightIlluminant(5000));
    EXPECT_EQ(White(Sensor(name, 0), *DaylightIlluminant(5000)), given) << name;
  }
}

// The sRGB values of the patches as the maker of the chart publishes them (X-Rite, "Colorimetric values for
// ColorChecker family of targets"), for D65.
constexpr int kPublished[24][3] = {
    {115, 82, 68},   {194, 150, 130}, {98, 122, 157},  {87, 108, 67},   {133, 128, 177}, {103, 189, 170},
    {214, 126, 44},  {80, 91, 166},   {193, 90, 99},   {94, 60, 108},   {157, 188, 64},  {224, 163, 46},
    {56, 61, 150},   {70, 148, 73},   {175, 54, 60},   {231, 199, 31},  {187, 86, 149},  {8, 133, 161},
    {243, 243, 242}, {200, 200, 200}, {160, 160, 160}, {122, 122, 121}, {85, 85, 85},    {52, 52, 52}};

TEST(FilmSensor, EverySensorSeesTheChartInItsPublishedColours) {
  const auto daylight = NamedSpectrum("stdillum-D65");
  ASSERT_TRUE(daylight);
  for (const std::string_view name : AllSensors()) {
    const FilmSensor sensor = Sensor(name);
    float sum = 0, largest = 0;
    for (size_t i = 0; i < 24; ++i) {
      const Rgb rgb = Seen(sensor, *daylight, &ColorCheckerPatches()[i]);
      for (int c = 0; c < 3; ++c) {
        const float difference = std::abs(Encoded(rgb[c]) - static_cast<float>(kPublished[i][c]) / 255);
        sum += difference;
        largest = std::max(largest, difference);
      }
    }
    const bool is_observer = name == "cie1931";
    EXPECT_LT(sum / 72, is_observer ? 0.012f : 0.018f) << name;
    // Where cameras differ most from the observer: in deep blue.
    EXPECT_LT(largest, is_observer ? 0.06f : 0.13f) << name;
  }
}

TEST(FilmSensor, ExposureScalesAndTheClampBoundsTheLargestComponent) {
  const auto daylight = NamedSpectrum("stdillum-D65");
  for (const std::string_view name : {"cie1931", "nikon_d850"}) {
    const Rgb plain = White(Sensor(name), *daylight);
    const Rgb bright = White(Sensor(name, 0, {.imaging_ratio = 2.5f}), *daylight);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(bright[c], 2.5f * plain[c], 1e-4f);
    // A clamp far above all samples changes nothing, one below them all makes every sample as large.
    const Rgb free = White(Sensor(name, 0, {.component_max = 1e6f}), *daylight);
    EXPECT_EQ(free, plain);
    EXPECT_LT(White(Sensor(name, 0, {.component_max = 0.1f}), *daylight).y, 0.5f * plain.y);
  }
}

TEST(FilmSensor, UnknownSensorsAreNone) {
  EXPECT_FALSE(FilmSensor::Measured("kodak", ColorSpace::Srgb(), {}, 0));
  // Named spectra that are no sensors.
  EXPECT_FALSE(FilmSensor::Measured("metal-Au", ColorSpace::Srgb(), {}, 0));
}

}  // namespace
}  // namespace tessera::film_sensor
