// What the header of a picture says of its camera and of its place in a sequence.
#include "renderer/scene/frame_attributes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <sstream>

#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

using Attributes = std::map<std::string, std::string>;

std::unique_ptr<Scene> LoadFrameOf(const std::string& head, const RenderOptions& options) {
  MemoryFiles files({{"scene.pbrt", head + "\nWorldBegin LightSource \"infinite\" Shape \"sphere\"\n"}});
  auto scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kCheck);
  if (!scene) throw std::runtime_error(scene.error().message);
  return std::move(*scene);
}

Attributes AttributesOf(const std::string& head, const RenderOptions& options = {}) {
  return LoadFrameOf(head, options)->frame().attributes;
}

// A point times a matrix of the header, as OpenEXR has it: a row vector.
std::array<float, 3> Apply(const std::string& matrix, std::array<float, 3> point) {
  std::istringstream in(matrix);
  std::array<std::array<float, 4>, 4> m{};
  for (auto& row : m) {
    for (float& value : row) in >> value;
  }
  EXPECT_TRUE(in) << matrix;
  std::array<float, 4> out{};
  for (size_t column = 0; column < 4; ++column)
    out[column] = point[0] * m[0][column] + point[1] * m[1][column] + point[2] * m[2][column] + m[3][column];
  return {out[0] / out[3], out[1] / out[3], out[2] / out[3]};
}

void ExpectNear(std::array<float, 3> found, std::array<float, 3> expected) {
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-5f) << i;
}

constexpr const char* kStill =
    "LookAt 1 2 3  2 2 3  0 0 1\n"  // along +x, up is +z
    "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n"
    "Camera \"perspective\" \"float fov\" 90\n";

TEST(FrameAttributes, WorldToCameraLooksAlongZ) {
  const std::string matrix = AttributesOf(kStill).at("worldToCamera");
  ExpectNear(Apply(matrix, {1, 2, 3}), {0, 0, 0});
  ExpectNear(Apply(matrix, {6, 2, 3}), {0, 0, 5});
  ExpectNear(Apply(matrix, {1, 2, 4}), {0, 1, 0});
  // Left-handed as in pbrt: right is up x forward, z x x = y.
  ExpectNear(Apply(matrix, {1, 3, 3}), {1, 0, 0});
}

TEST(FrameAttributes, WorldToNdcReachesFromMinusOneToOneOverThePicture) {
  const std::string matrix = AttributesOf(kStill).at("worldToNDC");
  // 90 degrees are those of the shorter side, which is the height.
  const auto top = Apply(matrix, {2, 2, 4}), right = Apply(matrix, {2, 4, 3}),
             middle = Apply(matrix, {9, 2, 3});
  EXPECT_NEAR(top[0], 0, 1e-5f);
  EXPECT_NEAR(top[1], 1, 1e-5f);
  EXPECT_NEAR(right[0], 1, 1e-5f);
  EXPECT_NEAR(right[1], 0, 1e-5f);
  EXPECT_NEAR(middle[0], 0, 1e-5f);
  EXPECT_LT(top[2], middle[2]) << "what is farther has the larger depth";
}

TEST(FrameAttributes, ACameraThatIsNoProjectionHasNoNdc) {
  const Attributes spherical = AttributesOf("Camera \"spherical\"");
  EXPECT_TRUE(spherical.contains("worldToCamera"));
  EXPECT_FALSE(spherical.contains("worldToNDC"));
  EXPECT_TRUE(AttributesOf("Camera \"orthographic\"").contains("worldToNDC"));
}

TEST(FrameAttributes, PixelsThatAreNotSquareSaySo) {
  EXPECT_FALSE(AttributesOf(kStill).contains("pixelAspectRatio"));
  const std::string wide =
      "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100\n"
      "Camera \"perspective\" \"float frameaspectratio\" 2\n";
  EXPECT_EQ(AttributesOf(wide).at("pixelAspectRatio"), "2");
}

TEST(FrameAttributes, PixelsOfAnAspectThatOpenExrRefusesSayNothing) {
  for (const char* aspect : {"1e7", "1e-7", "1e30"}) {
    const std::string film = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n";
    const std::string camera = std::string("Camera \"perspective\" \"float frameaspectratio\" ") + aspect;
    EXPECT_FALSE(AttributesOf(film + camera).contains("pixelAspectRatio")) << aspect;
  }
}

TEST(FrameAttributes, AFrameOfASequenceHasItsNumberAndTimeCode) {
  EXPECT_FALSE(AttributesOf(kStill).contains("frame"));
  RenderOptions options;
  options.frame = 24 * 3600 + 49;
  options.frames_per_second = 24;
  const Attributes attributes = AttributesOf(kStill, options);
  EXPECT_EQ(attributes.at("frame"), "86449");
  EXPECT_EQ(attributes.at("framesPerSecond"), "24/1");
  EXPECT_EQ(attributes.at("timeCode"), "01:00:02:01");
}

TEST(FrameAttributes, RatesAreThoseOfOtherPrograms) {
  EXPECT_EQ(FramesPerSecondText(25), "25/1");
  EXPECT_EQ(FramesPerSecondText(23.976), "24000/1001");
  EXPECT_EQ(FramesPerSecondText(29.97), "30000/1001");
  EXPECT_EQ(FramesPerSecondText(12.5), "12500/1000");
  EXPECT_EQ(FramesPerSecondText(0.0001), "1/1000");
  EXPECT_EQ(TimeCodeText(-1, 24), "");
  EXPECT_EQ(TimeCodeText(5, 23.976), "");
  EXPECT_EQ(TimeCodeText(5, 120), "");
  EXPECT_EQ(TimeCodeText(24 * 3600 * 24, 24), "00:00:00:00") << "a day is the longest";
}

// The client reads the scene once for all frames of a sequence; each worker reads it for its own frame.
TEST(FrameAttributes, ThoseOfEveryFrameFollowFromAnyFrameToTheBit) {
  const std::string path =
      "ActiveTransform EndTime Translate 3 1 0 Rotate 77 1 2 3 ActiveTransform All\n"
      "TransformTimes 0 9\n";
  for (const char* camera : {"Camera \"perspective\"", "Camera \"perspective\" \"float shutteropen\" 0.1",
                             "Camera \"perspective\" \"float shutterclose\" 0.02"}) {
    RenderOptions first;
    first.frame = 0;
    first.frames_per_second = 24;
    first.time = 0;
    const auto scene = LoadFrameOf(path + camera, first);
    std::string previous;
    for (const int frame : {1, 7, 24, 47, 100}) {
      RenderOptions options = first;
      options.frame = frame;
      options.time = frame / 24.0;
      Attributes attributes = scene->frame().attributes;
      scene->SetFrameAttributes(options, attributes);
      EXPECT_EQ(attributes, AttributesOf(path + camera, options)) << camera << " " << frame;
      EXPECT_NE(attributes.at("worldToCamera"), previous);
      previous = attributes.at("worldToCamera");
    }
  }
}

TEST(FrameAttributes, EverySceneFramePassesTheChecksOfItsAttributes) {
  for (const char* head :
       {"Scale -1 1 1", "Scale 1e-9 1e-9 1e-9", "Scale 1e9 1e9 1e9", "Translate 1e9 0 0"}) {
    const auto scene = LoadFrameOf(std::string(head) + "\nCamera \"perspective\"", {});
    EXPECT_TRUE(scene->frame().Check()) << head;
  }
}

}  // namespace
}  // namespace tessera
