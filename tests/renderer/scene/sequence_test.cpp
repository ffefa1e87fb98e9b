// Frames of a sequence: what moves, and what they share.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "renderer/scene/scene.h"
#include "tests/build_paths.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kFilm =
    "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 Sampler \"independent\"\n";

std::unique_ptr<Scene> LoadFrame(FileSource& files, std::optional<double> time = {}) {
  RenderOptions options;
  options.time = time;
  options.samples_per_pixel = 4;
  auto scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : nullptr;
}

std::vector<float> Render(const Scene& scene) {
  return scene.Render({0, 0, 8, 8}, {}, {0, 4}, nullptr)->sums;
}

TEST(Sequence, WhatMovesIsElsewhereAtAnotherTime) {
  MemoryFiles files(
      {{"scene.pbrt", std::string(kFilm) +
                          "Camera \"perspective\" WorldBegin LightSource \"infinite\" Translate 0 0 3\n"
                          "ActiveTransform EndTime Translate 3 0 0 ActiveTransform All\n"
                          "Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"sphere\""}});
  const auto start = LoadFrame(files, 0), middle = LoadFrame(files, 0.5), rest = LoadFrame(files, 1),
             after = LoadFrame(files, 2);
  EXPECT_NE(Render(*start), Render(*middle));
  EXPECT_NE(Render(*middle), Render(*rest));
  EXPECT_EQ(Render(*rest), Render(*after));
  EXPECT_NE(Render(*middle), Render(*LoadFrame(files))) << "a shutter from 0 to 1 blurs";
  EXPECT_EQ(start->frame(), middle->frame());
  EXPECT_EQ(start->summary().moving, 1u);
  EXPECT_THAT(start->summary().warnings,
              Contains(HasSubstr("at the time of the frame, without motion blur")));
}

// A frame with the times of the scene, rendered alone, has the same rays as one of a sequence whose shutter
// is relative to its time.
TEST(Sequence, TheShutterOfASceneOpensRelativeToTheTimeOfTheFrame) {
  const auto scene = [](const char* shutter) {
    return std::string(kFilm) + "TransformTimes 0 4 Camera \"perspective\" " + shutter +
           " WorldBegin LightSource \"infinite\" Translate 0 0 3\n"
           "ActiveTransform EndTime Translate 3 0 0 ActiveTransform All\n"
           "Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"sphere\"";
  };
  MemoryFiles sequence({{"scene.pbrt", scene("\"float shutteropen\" 0.5 \"float shutterclose\" 1.5")}});
  MemoryFiles alone({{"scene.pbrt", scene("\"float shutteropen\" 2.5 \"float shutterclose\" 3.5")}});
  const auto frame = LoadFrame(sequence, 2);
  const std::vector<float> picture = Render(*frame), same = Render(*LoadFrame(alone));
  double difference = 0, sum = 0;
  for (size_t i = 0; i < picture.size(); ++i) {
    difference += std::abs(static_cast<double>(picture[i]) - static_cast<double>(same[i]));
    sum += std::abs(static_cast<double>(same[i]));
  }
  EXPECT_LE(difference, 0.01 * sum);
  EXPECT_NE(Render(*frame), Render(*LoadFrame(sequence, 0)));
  EXPECT_THAT(frame->summary().warnings, testing::IsEmpty());
}

// The float that is nearest to such a time may be a second away.
TEST(Sequence, AFrameAfterMonthsIsAsSmoothAsTheFirst) {
  const auto scene = [](const char* times) {
    return std::string(kFilm) + times + " Camera \"perspective\" \"float shutterclose\" 0.02" +
           " WorldBegin LightSource \"infinite\" Translate 0 0 3\n"
           "ActiveTransform EndTime Translate 3 0 0 ActiveTransform All\n"
           "Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"sphere\"";
  };
  MemoryFiles late({{"scene.pbrt", scene("TransformTimes 16777216 16777220")}});
  MemoryFiles first({{"scene.pbrt", scene("TransformTimes 0 4")}});
  EXPECT_EQ(Render(*LoadFrame(late, 16777218)), Render(*LoadFrame(first, 2)));
}

TEST(Sequence, AMovingCameraMoves) {
  MemoryFiles files(
      {{"scene.pbrt", std::string(kFilm) +
                          "ActiveTransform EndTime Translate 1 0 0 ActiveTransform All\n"
                          "Camera \"perspective\" WorldBegin LightSource \"infinite\" Translate 0 0 3\n"
                          "Material \"diffuse\" Shape \"sphere\""}});
  EXPECT_NE(Render(*LoadFrame(files, 0)), Render(*LoadFrame(files, 1)));
}

TEST(Sequence, ATimeSurvivesItsCodec) {
  RenderOptions options;
  options.time = 17.0 / 24;
  const auto decoded = DecodeRenderOptions(EncodeRenderOptions(options));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, options);
  EXPECT_FALSE(DecodeRenderOptions("time=inf\ntile-size=32\n"));
  EXPECT_FALSE(DecodeRenderOptions("time=soon\ntile-size=32\n"));
}

// A folder with a scene that has a texture and a mesh.
class SharedFiles : public testing::Test {
 protected:
  SharedFiles() : folder_(testing::TempDir() + "sequence-" + std::to_string(::getpid())) {
    std::filesystem::create_directories(folder_);
    std::filesystem::copy_file(SourceDir() + "/tests/scenes/original/earth.jpg", folder_ + "/map.jpg",
                               std::filesystem::copy_options::overwrite_existing);
    WriteMesh(1);
    Write("scene.pbrt", std::string(kFilm) +
                            "Camera \"perspective\" WorldBegin LightSource \"infinite\" Translate 0 0 3\n"
                            "Texture \"map\" \"spectrum\" \"imagemap\" \"string filename\" \"map.jpg\"\n"
                            "Material \"diffuse\" \"texture reflectance\" \"map\" Shape \"sphere\"\n"
                            "Shape \"plymesh\" \"string filename\" \"mesh.ply\"");
  }
  ~SharedFiles() override { std::filesystem::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ + "/" + name) << text;
  }
  void WriteMesh(int size) {
    const std::string s = std::to_string(size);
    Write("mesh.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n-" +
              s + " 0 -1.5\n" + s + " 0 -1.5\n0 " + s + " -1.5\n3 0 1 2\n");
  }
  std::vector<float> RenderWith(std::shared_ptr<SharedCache> cache) {
    DiskFileSource files(folder_, std::move(cache));
    const auto picture = Render(*LoadFrame(files));
    EXPECT_EQ(files.FilesRead().size(), 3u) << "what is shared counts as read";
    return picture;
  }
  std::string folder_;
};

TEST_F(SharedFiles, GiveTheSameBitsAsThoseReadAlone) {
  const auto cache = std::make_shared<SharedCache>(uint64_t{1} << 30);
  const std::vector<float> alone = RenderWith(nullptr);
  EXPECT_EQ(RenderWith(cache), alone);
  const uint64_t bytes = cache->bytes();
  EXPECT_GT(bytes, 500'000u) << "the decoded picture";
  EXPECT_EQ(RenderWith(cache), alone);
  EXPECT_EQ(cache->bytes(), bytes) << "nothing is decoded again";
}

TEST_F(SharedFiles, AFileThatChangedIsReadAgain) {
  const auto cache = std::make_shared<SharedCache>(uint64_t{1} << 30);
  const std::vector<float> before = RenderWith(cache);
  WriteMesh(10);
  EXPECT_NE(RenderWith(cache), before);
}

TEST_F(SharedFiles, ACacheTooSmallForThemChangesNothing) {
  const auto cache = std::make_shared<SharedCache>(10'000);
  EXPECT_EQ(RenderWith(cache), RenderWith(nullptr));
  EXPECT_EQ(RenderWith(cache), RenderWith(nullptr));
}

}  // namespace
}  // namespace tessera
