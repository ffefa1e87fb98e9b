#include "renderer/load/limited_load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "renderer/formats/loader/module_loader.h"
#include "renderer/util/load_budget.h"
#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr uint64_t kMegabyte = uint64_t{1} << 20;

using LoadedScene = Result<std::shared_ptr<const Scene>>;

// A scene with a mesh of this many triangles.
std::string SceneWithMesh(int triangles) {
  std::string scene = std::string(kTinyScene) + "Shape \"trianglemesh\" \"point3 P\" [";
  for (int i = 0; i < triangles; ++i) scene += " 0 0 5  1 0 5  1 1 5";
  scene += "] \"integer indices\" [";
  for (int i = 0; i < 3 * triangles; ++i) scene += " " + std::to_string(i);
  return scene + "]\n";
}

LoadedScene Load(const std::string& text, const LoadLimits& limits, const RenderOptions& options = {}) {
  BlobMap blobs;
  const SceneRequest order = MakeOrder(blobs, text, options);
  const FetchBlob fetch = blobs.Fetcher();
  return LoadWithinLimits("scene.pbrt", limits, [&] { return LoadOrderedScene(order, fetch); });
}

TEST(LimitedLoad, ASceneWithinTheLimitsIsLoaded) {
  const auto scene = Load(SceneWithMesh(100'000), {500 * kMegabyte, 60s});
  EXPECT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(LoadBudget::Current(), nullptr);
}

TEST(LimitedLoad, ASceneThatNeedsMoreMemoryFailsWithTheLimit) {
  for (const char* accelerator : {"embree", "bvh"}) {
    RenderOptions options;
    options.accelerator = accelerator;
    const auto scene = Load(SceneWithMesh(100'000), {16 * kMegabyte, 60s}, options);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, HasSubstr("scene.pbrt: "));
    EXPECT_THAT(scene.error().message, HasSubstr("more than 16 MiB of memory (--scene-memory)"));
  }
}

TEST(LimitedLoad, AnyMemoryLimitIsAnErrorOrASceneButNoCrash) {
  const std::string text = SceneWithMesh(20'000);
  int loaded = 0;
  for (uint64_t kilobytes = 64; kilobytes < 64 * 1024; kilobytes = kilobytes * 5 / 4)
    loaded += Load(text, {kilobytes << 10, 60s}) ? 1 : 0;
  EXPECT_GT(loaded, 0);
}

TEST(LimitedLoad, ASceneThatTakesTooLongFailsWithTheLimit) {
  BlobMap blobs;
  const SceneRequest order = MakeOrder(blobs, kTinyScene);
  const FetchBlob fetch = [&](const Digest& digest, uint64_t size_max) {
    std::this_thread::sleep_for(700ms);
    return blobs.Fetcher()(digest, size_max);
  };
  const auto scene =
      LoadWithinLimits("scene.pbrt", {500 * kMegabyte, 1s}, [&] { return LoadOrderedScene(order, fetch); });
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("longer than 1 s (--load-timeout)"));
}

TEST(LimitedLoad, ALibraryThatDoesNotReturnEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto load = []() -> LoadedScene {
    std::promise<void>().get_future().wait();
    return Failed("unreachable");
  };
  const LoadLimits limits{500 * kMegabyte, 1s, "--scene-memory", 1s};
  EXPECT_EXIT(
      (void)LoadWithinLimits("scene.pbrt", limits, load), testing::ExitedWithCode(1),
      "scene.pbrt: loading the scene takes longer than 1 s .--load-timeout., and does not stop within 1 s");
}

TEST(LimitedLoad, AFailureNamesTheScenesFaultOrTheLimitOfTheWorker) {
  BlobMap blobs;
  const LoadLimits ample{500 * kMegabyte, 60s};
  const auto load = [&](const std::string& text, const LoadLimits& limits, const FetchBlob& fetch) {
    const SceneRequest order = MakeOrder(blobs, text);
    LoadOutcome outcome = LoadOrderedScene(order, limits, fetch);
    EXPECT_NE(outcome.scene == nullptr, outcome.reason.empty());
    return outcome;
  };
  const FetchBlob fetch = blobs.Fetcher();
  const auto fail_with = [](const Error& error) {
    return [=](const Digest&, uint64_t) -> Result<std::string> { return error; };
  };
  EXPECT_NE(load(kTinyScene, ample, fetch).scene, nullptr);
  EXPECT_EQ(load("nonsense", ample, fetch).cause, FailureCause::kScene);
  EXPECT_EQ(load(SceneWithMesh(100'000), {16 * kMegabyte, 60s}, fetch).cause, FailureCause::kWorkerLimit);
  EXPECT_EQ(load(kTinyScene, ample, fail_with(Failed("the download was given up"))).cause,
            FailureCause::kWorkerLimit);
  EXPECT_EQ(load(kTinyScene, ample, fail_with(BadInput("there is no such file"))).cause,
            FailureCause::kScene);
}

TEST(LimitedLoad, WhatLoadingThrowsIsAnError) {
  const auto scene = LoadWithinLimits("scene.pbrt", {500 * kMegabyte, 60s},
                                      []() -> LoadedScene { throw std::runtime_error("a library failed"); });
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().message, "scene.pbrt: a library failed");
}

TEST(LimitedLoad, OtherThreadsAllocateFreely) {
  const auto scene = LoadWithinLimits("scene.pbrt", {kMegabyte, 60s}, []() -> LoadedScene {
    std::jthread([] { const std::string large(64 * kMegabyte, 'x'); }).join();
    return Failed("done");
  });
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().message, "done");
}

[[noreturn]] void LoadImageModuleAndExit() {
  bool loads = false;
  const auto scene = LoadWithinLimits("scene.pbrt", {kMegabyte, 60s}, [&loads]() -> LoadedScene {
    loads = image_module::Load().has_value();
    return Failed("done");
  });
  std::_Exit(loads && !scene && scene.error().message == "done" ? 0 : 1);
}

// In a new process, because the module is loaded once.
TEST(LimitedLoad, LibrariesThatPicturesNeedAreNotPartOfTheScene) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(LoadImageModuleAndExit(), testing::ExitedWithCode(0), "");
}

TEST(LimitedLoad, TheDefaultIsHalfOfTheUsableMemory) {
  EXPECT_GT(UsableMemory(), 100 * kMegabyte);
  EXPECT_EQ(DefaultSceneMemory(), UsableMemory() / 2);
}

}  // namespace
}  // namespace tessera
