// What moves while the shutter is open, against coverage in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/renderer/scene/moving_pictures.h"

namespace tessera::motion_blur {
namespace {

constexpr int kSize = kMovingSize;
constexpr float kHalfWindow = 4;    // the picture shows x and y from -4 to 4
constexpr int kPlacesPerPixel = 8;  // along each axis, at which closed forms are evaluated

std::vector<float> Render(const std::string& text, const std::string& accelerator = "bvh") {
  return GreenOf(text, accelerator);
}

// Black things before an even sky.
std::string SceneText(const std::string& shutter, const std::string& before, const std::string& world) {
  return MovingHead("\"path\" \"integer maxdepth\" 1", before, shutter) +
         "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n"
         "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ] Translate 0 0 5\n" +
         world;
}

constexpr const char* kSquare = "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]\n";

std::string Moving(const std::string& motion, const std::string& shape) {
  return "ActiveTransform EndTime " + motion + " ActiveTransform All\n" + shape;
}

// Whether (x, y) is covered at a time in [0, 1] of the shutter.
using Cover = std::function<bool(double x, double y, double time)>;

void ExpectCoverage(const std::string& text, const Cover& is_covered, double tolerance = 0.015) {
  const std::vector<float> picture = Render(text), sky = Render(SceneText("", "", ""));
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      int covered = 0, places = 0;
      for (int place = 0; place < kPlacesPerPixel * kPlacesPerPixel; ++place) {
        const double in_x = (place % kPlacesPerPixel + 0.5) / kPlacesPerPixel;
        const double in_y = (place / kPlacesPerPixel + 0.5) / kPlacesPerPixel;
        const double x = (column + in_x) / kSize * 2 * kHalfWindow - kHalfWindow;
        const double y = kHalfWindow - (row + in_y) / kSize * 2 * kHalfWindow;
        for (int i = 0; i < 200; ++i, ++places) covered += is_covered(x, y, (i + 0.5) / 200);
      }
      const auto pixel = static_cast<size_t>(row * kSize + column);
      ASSERT_NEAR(1 - picture[pixel] / sky[pixel], static_cast<double>(covered) / places, tolerance)
          << column << " " << row;
    }
  }
}

bool InSquare(double x, double y) {
  return std::abs(x) < 1 && std::abs(y) < 1;
}

TEST(MotionBlur, ASquareThatTravelsCoversEachPlaceForItsShareOfTheTime) {
  ExpectCoverage(SceneText("", "", "Translate -2.5 0 0\n" + Moving("Translate 5 1 0", kSquare)),
                 [](double x, double y, double t) { return InSquare(x + 2.5 - 5 * t, y - t); });
}

TEST(MotionBlur, ASphereThatTravelsCoversEachPlaceForItsShareOfTheTime) {
  ExpectCoverage(SceneText("", "", "Translate -2 0 0\n" + Moving("Translate 4 0 0", "Shape \"sphere\"")),
                 [](double x, double y, double t) { return std::hypot(x + 2 - 4 * t, y) < 1; });
}

TEST(MotionBlur, ABarThatTurnsCoversTheSectorThatItSweeps) {
  ExpectCoverage(SceneText("", "", Moving("Rotate 90 0 0 1", "Scale 3 0.25 1\n" + std::string(kSquare))),
                 [](double x, double y, double t) {
                   const double c = std::cos(t * std::numbers::pi / 2),
                                s = std::sin(t * std::numbers::pi / 2);
                   return std::abs(c * x + s * y) < 3 && std::abs(c * y - s * x) < 0.25;
                 });
}

TEST(MotionBlur, WhatGrowsCoversMoreAndMore) {
  ExpectCoverage(SceneText("", "", Moving("Scale 3 0.5 1", kSquare)),
                 [](double x, double y, double t) { return InSquare(x / (1 + 2 * t), y / (1 - 0.5 * t)); });
}

TEST(MotionBlur, OnlyTheTimeBetweenOpeningAndClosingCounts) {
  const std::string shutter = "\"float shutteropen\" 0.25 \"float shutterclose\" 0.5";
  const std::vector<float> sky = Render(SceneText(shutter, "", ""));
  const std::vector<float> longer = Render(SceneText("", "", ""));
  EXPECT_NEAR(sky[0] / longer[0], 0.25, 1e-3) << "the exposure";
  const std::string world = "Translate -2.5 0 0\n" + Moving("Translate 5 0 0", kSquare);
  const std::vector<float> picture = Render(SceneText(shutter, "", world));
  for (int column = 0; column < kSize; ++column) {
    double covered = 0;
    for (int i = 0; i < 1000; ++i) {
      const double x = (column + 0.5) / kSize * 8 - 4, t = 0.25 + 0.25 * (i % 100 + 0.5) / 100;
      covered += std::abs(x + (i / 100 + 0.5) / 20 - 0.25 + 2.5 - 5 * t) < 1;
    }
    const auto pixel = static_cast<size_t>(8 * kSize + column);
    EXPECT_NEAR(1 - picture[pixel] / sky[pixel], covered / 1000, 0.02) << column;
  }
}

TEST(MotionBlur, AnInstanceWhosePartsMoveMovesInBothWays) {
  const std::string object = "ObjectBegin \"o\"\n" + Moving("Translate 0 3 0", kSquare) + "ObjectEnd\n";
  ExpectCoverage(
      SceneText("", "", object + "Translate -2 -2 0\n" + Moving("Translate 4 0 0", "ObjectInstance \"o\"")),
      [](double x, double y, double t) { return InSquare(x + 2 - 4 * t, y + 2 - 3 * t); });
}

TEST(MotionBlur, AMovingCameraBlursWhatStandsStill) {
  // The camera goes to the right, so that the square goes to the left.
  const std::string camera = "ActiveTransform EndTime Translate -4 0 0 ActiveTransform All";
  ExpectCoverage(SceneText("", camera, "Translate 2 0 0\n" + std::string(kSquare)),
                 [](double x, double y, double t) { return InSquare(x - 2 + 4 * t, y); });
}

TEST(MotionBlur, ACameraThatTurnsBlursLikeAWorldThatTurns) {
  const std::string camera = "ActiveTransform EndTime Rotate 90 0 0 1 ActiveTransform All";
  ExpectCoverage(
      SceneText("", camera, "Scale 3 0.25 1\n" + std::string(kSquare)), [](double x, double y, double t) {
        const double c = std::cos(t * std::numbers::pi / 2), s = std::sin(t * std::numbers::pi / 2);
        return std::abs(c * x + s * y) < 3 && std::abs(c * y - s * x) < 0.25;
      });
}

TEST(MotionBlur, WhatMovesWithTheCameraStaysSharp) {
  const std::string camera = "ActiveTransform EndTime Translate -30 0 0 ActiveTransform All";
  ExpectCoverage(SceneText("", camera, Moving("Translate 30 0 0", kSquare)),
                 [](double x, double y, double) { return InSquare(x, y); });
}

// One of the maps of TransformTimes after the other, in one step.
TEST(MotionBlur, TransformTimesThatDoNotRiseAreAJump) {
  for (const char* times : {"TransformTimes 0.5 0.5", "TransformTimes 0.5 0"}) {
    ExpectCoverage(SceneText("", times, Moving("Translate 2 0 0", kSquare)),
                   [](double x, double y, double t) { return InSquare(t < 0.5 ? x : x - 2, y); });
  }
}

// The mirror image of x is half a turn about x with the opposite of all axes.
TEST(MotionBlur, WhatTurnsIntoItsMirrorImageIsFlatForAMomentAndSeenBeforeAndAfter) {
  ExpectCoverage(SceneText("", "", Moving("Scale -1 1 1", kSquare)), [](double x, double y, double t) {
    const double scale = 1 - 2 * t;
    return InSquare(x / scale, y / (scale * std::cos(t * std::numbers::pi)));
  });
}

TEST(MotionBlur, WhatGrowsFromNothingIsSeen) {
  const std::string world = "ActiveTransform StartTime Scale 0 0 0 ActiveTransform All\n";
  ExpectCoverage(SceneText("", "", world + kSquare),
                 [](double x, double y, double t) { return InSquare(x / t, y / t); });
}

constexpr const char* kManyThings = R"(
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.2 ]
AttributeBegin Translate -2 1 0 ActiveTransform EndTime Rotate 120 1 1 0 Translate 1 0 0
  Shape "cylinder" "float zmin" -1 "float zmax" 1
  Shape "curve" "point3 P" [ -2 0 0  -1 2 0  1 -2 1  2 0 0 ] "float width" 0.3 "string type" "cylinder"
  Shape "curve" "point3 P" [ -2 0 1  -1 2 1  1 -2 2  2 0 1 ] "float width" 0.3 "string type" "cylinder"
AttributeEnd
ObjectBegin "o"
  Shape "sphere" "float radius" 0.8 "float zmax" 0.5
  Shape "trianglemesh" "point3 P" [ -1 -1 -1  1 -1 -1  0 1 1 ] "integer indices" [ 0 1 2 ] "float alpha" 0.7
ObjectEnd
AttributeBegin Translate 2 -1 0 ActiveTransform EndTime Scale 2 0.5 1 ObjectInstance "o" AttributeEnd
Translate 1 2 1 ObjectInstance "o"
)";

TEST(MotionBlur, GivesTheSameBitsWithEveryAccelerator) {
  const std::string text =
      SceneText("", "ActiveTransform EndTime Rotate 10 0 1 0 ActiveTransform All", kManyThings);
  const std::vector<float> list = Render(text, "list");
  EXPECT_EQ(Render(text, "bvh"), list);
  EXPECT_EQ(Render(text, "embree"), list);
}

TEST(MotionBlur, AMotionThatLeavesTheRangeOfFloatsIsRefusedWithItsPlace) {
  MemoryFiles files;
  files.files["a.pbrt"] =
      "WorldBegin LightSource \"infinite\" Scale 1e30 1e30 1e30\n"
      "ActiveTransform EndTime Translate 1e8 0 0 Scale 1e7 1 1 Shape \"sphere\"";
  const auto scene = Scene::Load(files, "a.pbrt", {}, Scene::Depth::kCheck);
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, testing::HasSubstr("a.pbrt:2:"));
}

}  // namespace
}  // namespace tessera::motion_blur
