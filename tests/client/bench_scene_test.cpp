#include "client/bench_scene.h"

#include <gtest/gtest.h>

#include "client/scene_frames.h"

namespace tessera {
namespace {

TEST(BenchScene, CanBeRenderedWithoutFilesAndWarnings) {
  SceneFrame frame;
  frame.path = "bench.pbrt";
  frame.text = std::make_shared<const std::string>(BenchScene());
  const auto loaded = LoadFrame(frame, Scene::Depth::kCheck, nullptr);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->scene->summary().warnings.empty()) << loaded->scene->summary().warnings.front();
  EXPECT_EQ(loaded->files.size(), 1u) << "the scene itself";
  EXPECT_EQ(loaded->scene->frame().samples_per_pixel, 16u);
}

}  // namespace
}  // namespace tessera
