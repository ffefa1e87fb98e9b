// Lights that move while the shutter is open, against irradiance in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/renderer/scene/moving_pictures.h"

namespace tessera::moving_light {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr const char* kPath = "\"path\" \"integer maxdepth\" 1";

// A grey wall at z = 5 that faces the camera at z = 0, lit by what the camera does not see.
std::string Wall(const std::string& light, const std::string& integrator = kPath,
                 const std::string& shutter = "") {
  return MovingHead(integrator, "", shutter) + "AttributeBegin\n" + light +
         "\nAttributeEnd\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n"
         "Shape \"bilinearmesh\" \"point3 P\" [ -50 -50 5  50 -50 5  -50 50 5  50 50 5 ]\n";
}

// Moves from the current place by `motion`.
std::string Moving(const std::string& motion) {
  return "ActiveTransform EndTime " + motion + " ActiveTransform All\n";
}

// Relative irradiance at (x, y) of the wall at a time in [0, 1].
using Irradiance = std::function<double(double x, double y, double time)>;

// The mean of a pixel over its area and the time.
double PixelMean(const Irradiance& irradiance, int column, int row) {
  constexpr int kTimes = 256;
  double mean = 0;
  for (int i = 0; i < 16 * kTimes; ++i) {
    const double x = (column + (i % 4 + 0.5) / 4) / 2 - 4, y = 4 - (row + (i / 4 % 4 + 0.5) / 4) / 2;
    mean += irradiance(x, y, (i / 16 + 0.5) / kTimes) / (16 * kTimes);
  }
  return mean;
}

// Expects the picture of `moving` to be the mean over time of `irradiance`, relative to the same of a light
// that stands still.
void ExpectIrradiance(const std::string& moving, const std::string& still, const Irradiance& irradiance,
                      const Irradiance& still_irradiance, double tolerance = 0.02) {
  const std::vector<float> picture = GreenOf(moving), reference = GreenOf(still);
  double largest = 0, reference_sum = 0, still_sum = 0;
  for (int pixel = 0; pixel < kMovingSize * kMovingSize; ++pixel) {
    largest = std::max(largest, static_cast<double>(picture[static_cast<size_t>(pixel)]));
    reference_sum += static_cast<double>(reference[static_cast<size_t>(pixel)]);
    still_sum += PixelMean(still_irradiance, pixel % kMovingSize, pixel / kMovingSize);
  }
  ASSERT_GT(largest, 0);
  const double unit = reference_sum / still_sum;
  for (int row = 0; row < kMovingSize; ++row) {
    for (int column = 0; column < kMovingSize; ++column) {
      ASSERT_NEAR(static_cast<double>(picture[static_cast<size_t>(row * kMovingSize + column)]),
                  unit * PixelMean(irradiance, column, row), tolerance * largest)
          << column << " " << row;
    }
  }
}

// Of a point of unit intensity at (at_x, at_y, 5 - height).
double PointIrradiance(double x, double y, double at_x, double at_y, double height) {
  const double squared = (x - at_x) * (x - at_x) + (y - at_y) * (y - at_y) + height * height;
  return height / (squared * std::sqrt(squared));
}

double StillPoint(double x, double y, double) {
  return PointIrradiance(x, y, 0, 0, 2);
}

TEST(MovingLight, APointLightThatTravelsLightsFromEachPlaceForItsShareOfTheTime) {
  const std::string point = "LightSource \"point\" \"rgb I\" [ 9 9 9 ]";
  ExpectIrradiance(
      Wall("Translate -3 1 3\n" + Moving("Translate 6 -2 1") + point), Wall("Translate 0 0 3\n" + point),
      [](double x, double y, double t) { return PointIrradiance(x, y, -3 + 6 * t, 1 - 2 * t, 2 - t); },
      StillPoint);
}

TEST(MovingLight, AScaleMovesAPointLightButDoesNotDimIt) {
  const std::string point = "LightSource \"point\" \"rgb I\" [ 9 9 9 ] \"point3 from\" [ 1 0 3 ]";
  ExpectIrradiance(
      Wall(Moving("Scale 3 1 1") + point), Wall("Translate -1 0 0 " + point),
      [](double x, double y, double t) { return PointIrradiance(x, y, 1 + 2 * t, 0, 2); }, StillPoint);
}

// By every method of choosing between lights.
TEST(MovingLight, OneOfManyIsChosenWithTheSameMeanByEveryLightSampler) {
  const std::string point = "LightSource \"point\" \"rgb I\" [ 9 9 9 ]";
  const std::string lights =
      "Translate -3 0 3\n" + Moving("Translate 6 0 0") + point + "\nTranslate 1 2 0 " + point;
  for (const char* sampler : {"bvh", "power", "uniform"}) {
    const std::string integrator = std::string(kPath) + " \"string lightsampler\" \"" + sampler + "\"";
    ExpectIrradiance(
        Wall(lights, integrator), Wall("Translate 0 0 3\n" + point),
        [](double x, double y, double t) {
          return PointIrradiance(x, y, -3 + 6 * t, 0, 2) + PointIrradiance(x, y, -2 + 6 * t, 2, 2);
        },
        StillPoint, 0.03);
  }
}

TEST(MovingLight, ASpotlightThatTurnsSweepsTheWall) {
  // 4 before the wall, turning about y from 30 degrees left to 30 degrees right.
  const std::string spot =
      "LightSource \"spot\" \"rgb I\" [ 9 9 9 ] \"float coneangle\" 15 \"float conedeltaangle\" 0";
  const std::string wide =
      "LightSource \"spot\" \"rgb I\" [ 9 9 9 ] \"float coneangle\" 80 \"float conedeltaangle\" 0";
  ExpectIrradiance(
      Wall("Translate 0 0 1 Rotate -30 0 1 0\n" + Moving("Rotate 60 0 1 0") + spot),
      Wall("Translate 0 0 1 " + wide),
      [](double x, double y, double t) {
        const double angle = (-30 + 60 * t) * kPi / 180;
        const double along = (x * std::sin(angle) + 4 * std::cos(angle)) / std::sqrt(x * x + y * y + 16);
        return along > std::cos(15 * kPi / 180) ? PointIrradiance(x, y, 0, 0, 4) : 0;
      },
      [](double x, double y, double) { return PointIrradiance(x, y, 0, 0, 4); }, 0.03);
}

TEST(MovingLight, ADistantLightThatTurnsLightsWithTheMeanCosine) {
  const std::string distant = "LightSource \"distant\" \"rgb L\" [ 2 2 2 ]";
  ExpectIrradiance(
      Wall(Moving("Rotate 60 0 1 0") + distant), Wall(distant),
      [](double, double, double t) { return std::cos(60 * t * kPi / 180); },
      [](double, double, double) { return 1; });
}

TEST(MovingLight, AnEnvironmentThatTurnsIsTheMeanOfItsPositions) {
  const auto turned = [](double degrees) { return "Rotate " + std::to_string(degrees) + " 0 1 0 "; };
  const std::string sky = "LightSource \"infinite\" \"string filename\" \"sky.pfm\"";
  constexpr int kPositions = 25;
  double expected = 0;
  for (int i = 0; i < kPositions; ++i) {
    const std::vector<float> still = GreenOf(Wall(turned(20 + 100 * (i + 0.5) / kPositions) + sky));
    for (const float value : still) expected += static_cast<double>(value) / 256 / kPositions;
  }
  for (const char* integrator : {"\"path\"", "\"simplepath\"", "\"mixture\""}) {
    const std::vector<float> moving = GreenOf(Wall(turned(20) + Moving("Rotate 100 0 1 0") + sky,
                                                   std::string(integrator) + " \"integer maxdepth\" 1"));
    double mean = 0;
    for (const float value : moving) mean += static_cast<double>(value) / 256;
    EXPECT_NEAR(mean, expected, 0.01 * expected) << integrator;
  }
}

// A sphere that is not cut by the horizon gives the irradiance of a point in its middle.
TEST(MovingLight, ASphereThatEmitsAndTravelsLightsLikeAPoint) {
  const std::string sphere =
      "AreaLightSource \"diffuse\" \"rgb L\" [ 5 5 5 ] Shape \"sphere\" \"float radius\" 0.5";
  const std::string moving = "Translate -3 1 -1\n" + Moving("Translate 6 -2 -1 Rotate 50 1 1 0");
  const auto irradiance = [](double x, double y, double t) {
    return PointIrradiance(x, y, -3 + 6 * t, 1 - 2 * t, 6 + t);
  };
  const auto still = [](double x, double y, double) { return PointIrradiance(x, y, 0, 0, 6); };
  const std::string reference = Wall("Translate 0 0 -1 " + sphere);
  for (const char* integrator : {"\"path\"", "\"simplepath\"", "\"mixture\"", "\"volpath\""}) {
    ExpectIrradiance(Wall(moving + sphere, std::string(integrator) + " \"integer maxdepth\" 1"), reference,
                     irradiance, still, 0.03);
  }
}

// Sampled in a space that is stretched unevenly: the mean over time of what still ones give.
TEST(MovingLight, AMeshThatEmitsAndStretchesIsTheMeanOfItsShapes) {
  const std::string lamp =
      "AreaLightSource \"diffuse\" \"rgb L\" [ 5 5 5 ] \"bool twosided\" true\n"
      "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0  1 -1 0  1 1 0.3 -1 1 0 ] \"integer indices\" [ 0 1 2 0 "
      "2 3 ]\n";
  const auto at = [](double t) {
    const std::string scale = std::to_string(1 + 2 * t) + " " + std::to_string(1 - 0.5 * t);
    return "Translate 0 0 -1 Scale " + scale + " 1 ";
  };
  std::vector<double> expected(256, 0.0);
  for (int i = 0; i < 20; ++i) {
    const std::vector<float> still = GreenOf(Wall(at((i + 0.5) / 20) + lamp));
    for (size_t pixel = 0; pixel < 256; ++pixel) expected[pixel] += still[pixel] / 20;
  }
  for (const char* integrator : {"\"path\"", "\"simplepath\"", "\"mixture\""}) {
    const std::vector<float> moving = GreenOf(
        Wall(at(0) + Moving("Scale 3 0.5 1") + lamp, std::string(integrator) + " \"integer maxdepth\" 1"));
    for (size_t pixel = 0; pixel < 256; ++pixel)
      ASSERT_NEAR(moving[pixel], expected[pixel], 0.03 * expected[128]) << integrator << " " << pixel;
  }
}

TEST(MovingLight, ThePowerOfAnEmitterIsThatOfItsSizeWhenTheShutterOpens) {
  const auto lamp = [](const std::string& shape) {
    return "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"float power\" 300 " + shape;
  };
  const std::string sphere = lamp("Shape \"sphere\" \"float radius\" 0.25");
  const std::vector<float> still = GreenOf(Wall("Translate 0 0 -1 Scale 2 2 2 " + sphere));
  const std::vector<float> moving =
      GreenOf(Wall("Translate 0 0 -1 Scale 2 2 2 " + Moving("Translate 0.001 0 0") + sphere));
  EXPECT_NEAR(moving[130], still[130], 0.02f * still[130]);
  MemoryFiles files;
  files.files["a.pbrt"] = Wall("Translate 0 0 -1 Scale 2 1 1\n" + Moving("Translate 1 0 0") + sphere);
  const auto refused = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("requires the same scale along all axes"));
}

TEST(MovingLight, TheCameraSeesAnEmitterWhereItIsAtTheTime) {
  const std::string lamp =
      "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"bool twosided\" true\n"
      "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]\n";
  const std::string head = MovingHead(kPath) + "Translate 0 0 3 ";
  const std::vector<float> still = GreenOf(head + lamp);
  const std::vector<float> moving = GreenOf(head + "Translate -2 0 0\n" + Moving("Translate 4 0 0") + lamp);
  const size_t middle = 8 * kMovingSize + 8;
  EXPECT_NEAR(moving[middle] / still[middle], 0.5f, 0.02f) << "2 of the 4 units of the way";
  EXPECT_EQ(moving[1 * kMovingSize + 8], 0);
}

TEST(MovingLight, GivesTheSameBitsWithEveryAcceleratorAndAtAStandstill) {
  const std::string lights =
      Moving("Rotate 30 1 0 0 Translate 1 0 0") +
      "LightSource \"infinite\" \"string filename\" \"sky.pfm\" LightSource \"point\" \"point3 from\" [ 1 2 "
      "2 ]\n"
      "AreaLightSource \"diffuse\" Translate 0 1 1 Shape \"sphere\" \"float radius\" 0.3\n";
  const std::vector<float> list = GreenOf(Wall(lights), "list");
  EXPECT_EQ(GreenOf(Wall(lights), "bvh"), list);
  EXPECT_EQ(GreenOf(Wall(lights), "embree"), list);
  const std::string still =
      "LightSource \"infinite\" \"string filename\" \"sky.pfm\" LightSource \"point\" \"point3 from\" [ 1 2 "
      "2 ]\n"
      "AreaLightSource \"diffuse\" Translate 0 1 1 Shape \"sphere\" \"float radius\" 0.3\n";
  EXPECT_EQ(GreenOf(Wall(lights), "bvh", 0), GreenOf(Wall(still))) << "a frame at the time of the first key";
}

}  // namespace
}  // namespace tessera::moving_light
