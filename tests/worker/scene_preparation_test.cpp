// From a scene that was ordered to the frames of its job.
#include "worker/scene_preparation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// An order for the scene files of a package.
PreparationRequest OrderOfFiles(BlobMap& blobs, const std::map<std::string, std::string>& files,
                                const std::string& scene_file, const RenderOptions& options = {}) {
  ScenePackage package;
  for (const auto& [path, text] : files) package.files[path] = {blobs.Add(text), text.size()};
  PreparationRequest request;
  request.key = Sha256("key");
  request.scene.package = blobs.Add(EncodeScenePackage(package));
  request.scene.scene_file = scene_file;
  request.scene.options = EncodeRenderOptions(options);
  return request;
}

// Whether a worker that renders the frame finds in its scene what the frame says.
bool IsRendered(const PreparationRequest& request, const FrameRequest& frame, const BlobMap& blobs) {
  SceneRequest order;
  order.package = request.scene.package;
  order.scene_file = frame.scene_file;
  order.options = frame.options;
  order.frame = frame.spec;
  const auto scene = LoadOrderedScene(order, blobs.Fetcher());
  return scene.has_value();
}

TEST(ScenePreparation, MakesTheFrameThatOtherWorkersFindInTheScene) {
  BlobMap blobs;
  RenderOptions options;
  options.samples_per_pixel = 16;
  options.aovs = {"albedo"};
  const auto request =
      OrderOfFiles(blobs, {{"scene.pbrt", kTinyScene}, {"unused.pbrt", "no"}}, "scene.pbrt", options);
  const auto report = PrepareScene(request, blobs.Fetcher());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->key, request.key);
  ASSERT_EQ(report->frames.size(), 1u);
  const FrameRequest& frame = report->frames[0];
  EXPECT_EQ(frame.spec.samples_per_pixel, 16u);
  EXPECT_EQ(frame.options, request.scene.options);
  EXPECT_TRUE(frame.extendable);
  EXPECT_TRUE(IsRendered(request, frame, blobs));
}

TEST(ScenePreparation, ReadsEachFileOfASequence) {
  BlobMap blobs;
  auto request = OrderOfFiles(blobs, {{"s01.pbrt", kTinyScene}, {"s03.pbrt", kTinyScene}}, "s##.pbrt");
  request.scene.frames = FrameRange{1, 3, 2};
  const auto report = PrepareScene(request, blobs.Fetcher());
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->frames.size(), 2u);
  EXPECT_EQ(report->frames[1].scene_file, "s03.pbrt");
  EXPECT_EQ(report->frames[1].number, 3);
  for (const FrameRequest& frame : report->frames) EXPECT_TRUE(IsRendered(request, frame, blobs));
}

TEST(ScenePreparation, OfOneFileMakesTheFramesOfAnAnimationAndWarnsIfNothingMoves) {
  BlobMap blobs;
  auto request = OrderOfFiles(blobs, {{"scene.pbrt", kTinyScene}}, "scene.pbrt");
  request.scene.frames = FrameRange{0, 2, 1};
  const auto report = PrepareScene(request, blobs.Fetcher());
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->frames.size(), 3u);
  for (const FrameRequest& frame : report->frames) EXPECT_TRUE(IsRendered(request, frame, blobs));
  EXPECT_NE(report->frames[1].options, report->frames[2].options) << "another time";
  EXPECT_THAT(report->warnings, testing::Contains(HasSubstr("nothing in the scene moves")));
}

TEST(ScenePreparation, NamesThePlaceOfAMistake) {
  BlobMap blobs;
  const auto failure_of = [&](const PreparationRequest& request) {
    const auto report = PrepareScene(request, blobs.Fetcher());
    return report ? std::string() : report.error().message;
  };
  EXPECT_THAT(failure_of(OrderOfFiles(blobs, {{"scene.pbrt", "WorldBegin\nNonsense\n"}}, "scene.pbrt")),
              HasSubstr("scene.pbrt:2:1"));
  EXPECT_THAT(
      failure_of(OrderOfFiles(blobs, {{"scene.pbrt", std::string(kTinyScene) + "Include \"../more.pbrt\"\n"}},
                              "scene.pbrt")),
      HasSubstr("more.pbrt"));
  EXPECT_THAT(failure_of(OrderOfFiles(blobs, {{"scene.pbrt", kTinyScene}}, "other.pbrt")),
              HasSubstr("other.pbrt"));
  auto request = OrderOfFiles(blobs, {{"scene.pbrt", kTinyScene}}, "scene.pbrt");
  request.scene.options = "aov=nonsense\n";
  EXPECT_THAT(failure_of(request), HasSubstr("aov"));
  request.scene.package = Sha256("another package");
  EXPECT_NE(failure_of(request), "");
}

}  // namespace
}  // namespace tessera
