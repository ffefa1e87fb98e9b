#include "renderer/description/motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

// A sphere that goes from x = 0 to x = 10 between times 2 and 4.
constexpr const char* kMovingSphere =
    "TransformTimes 2 4 Camera \"perspective\" \"float shutteropen\" 2 \"float shutterclose\" 3 WorldBegin\n"
    "ActiveTransform EndTime Translate 10 0 0 ActiveTransform All Shape \"sphere\"";

float PlaceAt(double time_s) {
  SceneDescription scene = *ParseText(kMovingSphere);
  EXPECT_TRUE(StopMotion(time_s, scene));
  return scene.shapes[0].world_from_object.Fixed().ToPoint({0, 0, 0}).x;
}

TEST(StopMotion, PutsThingsWhereTheyAreAtTheTime) {
  EXPECT_FLOAT_EQ(PlaceAt(3), 5);
  EXPECT_FLOAT_EQ(PlaceAt(3.5), 7.5f);
}

TEST(StopMotion, ThingsRestBeforeTheFirstAndAfterTheLastTime) {
  EXPECT_EQ(PlaceAt(-7), 0);
  EXPECT_EQ(PlaceAt(2), 0);
  EXPECT_EQ(PlaceAt(4), 10);
  EXPECT_EQ(PlaceAt(1e9), 10);
}

TEST(StopMotion, TheCameraMovesNotTheWorldAroundIt) {
  SceneDescription scene = *ParseText(
      "ActiveTransform StartTime LookAt 0 0 -4  0 0 0  0 1 0 ActiveTransform EndTime LookAt 4 0 0  0 0 0  0 "
      "1 0 "
      "ActiveTransform All Camera \"perspective\" WorldBegin");
  ASSERT_TRUE(StopMotion(0.5, scene));
  const Point3 eye = scene.camera_from_world.Fixed().Inverse().ToPoint({0, 0, 0});
  EXPECT_NEAR(eye.x, 2, 1e-5);
  EXPECT_NEAR(eye.z, -2, 1e-5);
}

TEST(StopMotion, InstancesAndShapesInsideObjectsMove) {
  SceneDescription scene = *ParseText(
      "WorldBegin ObjectBegin \"o\" ActiveTransform EndTime Translate 2 0 0 Shape \"sphere\" ObjectEnd "
      "ActiveTransform EndTime Translate 0 4 0 ActiveTransform All ObjectInstance \"o\"");
  EXPECT_EQ(*CheckMotion(scene), 2);
  ASSERT_TRUE(StopMotion(0.5, scene));
  EXPECT_FLOAT_EQ(scene.objects[0].shapes[0].world_from_object.Fixed().ToPoint({0, 0, 0}).x, 1);
  EXPECT_FLOAT_EQ(scene.instances[0].world_from_object.Fixed().ToPoint({0, 0, 0}).y, 2);
}

TEST(StopMotion, ACameraThatIsSingularThenIsAnErrorWithItsPlace) {
  SceneDescription scene = *ParseText(
      "ActiveTransform EndTime Scale -1 -1 -1 ActiveTransform All\nCamera \"perspective\" WorldBegin");
  const auto stopped = StopMotion(0.5, scene);
  ASSERT_FALSE(stopped);
  EXPECT_THAT(stopped.error().message, testing::HasSubstr(":2:1: the camera has no volume at 0.5 s"));
  EXPECT_TRUE(StopMotion(0.25, scene));
}

std::string MotionError(const std::string& text) {
  const SceneDescription scene = *ParseText(text);
  const auto checked = CheckMotion(scene);
  return checked ? "" : checked.error().message;
}

TEST(CheckMotion, CountsWhatMoves) {
  EXPECT_EQ(*CheckMotion(*ParseText(kMovingSphere)), 1);
  EXPECT_EQ(*CheckMotion(*ParseText("WorldBegin Shape \"sphere\"")), 0);
}

TEST(CheckMotion, ACameraThatTurnsIntoItsMirrorImageIsAnErrorWithItsPlace) {
  EXPECT_THAT(
      MotionError(
          "ActiveTransform EndTime Scale -1 1 1 ActiveTransform All\nCamera \"perspective\" WorldBegin"),
      testing::HasSubstr(":2:1: the camera turns into its mirror image"));
  EXPECT_EQ(MotionError("Scale -1 1 1 ActiveTransform EndTime Translate 1 0 0 ActiveTransform All\n"
                        "Camera \"perspective\" WorldBegin"),
            "");
}

TEST(CheckMotion, WhatMovesByAProjectiveMapIsAnErrorWithItsPlace) {
  EXPECT_THAT(
      MotionError("WorldBegin ActiveTransform EndTime Transform [1 0 0 0  0 1 0 0  0 0 1 1  0 0 0 1]\n"
                  "ActiveTransform All Shape \"sphere\""),
      testing::HasSubstr(":2:21: what moves has a projective transformation"));
}

}  // namespace
}  // namespace tessera
