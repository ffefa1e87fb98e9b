// Which frames of a job are begun, and which workers load them.
#include <gtest/gtest.h>

#include <set>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

// Whatever the workers were told to load is ready after `load`.
void LoadScenes(SchedulerStage& stage, uint64_t workers, Instant load) {
  stage.Advance(load);
  for (uint64_t w = 1; w <= workers; ++w) {
    for (const SceneRequest& order : std::exchange(stage.told[w].scenes, {})) {
      stage.Worker(w).scenes.push_back({order.key, true});
    }
    stage.Send(w);
  }
  stage.Advance();
}

uint32_t FrameOf(const SchedulerStage& stage, JobId job, const Digest& scene) {
  uint32_t frame = 0;
  while (stage.SceneOf(job, frame) != scene) ++frame;
  return frame;
}

TEST(SchedulerFrames, TheNextSceneIsLoadedWhileTheFrameHasOpenWork) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64, 0, 3);
  stage.HaveScene(1, job, 0);
  stage.Send(1);
  stage.Advance();
  ASSERT_FALSE(stage.Held(1).empty());
  for (const Lease& lease : stage.Held(1)) EXPECT_EQ(lease.unit.frame, 0u);
  ASSERT_EQ(stage.told[1].scenes.size(), 1u);
  EXPECT_EQ(stage.told[1].scenes[0].key, stage.SceneOf(job, 1));
}

TEST(SchedulerFrames, OneSceneIsLoadedAheadNotAll) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64, 0, 8);
  stage.HaveScene(1, job, 0);
  stage.HaveScene(1, job, 1);
  stage.Send(1);
  stage.Advance();
  ASSERT_FALSE(stage.Held(1).empty());
  EXPECT_TRUE(stage.told[1].scenes.empty());
}

TEST(SchedulerFrames, WorkersDoNotWaitAtTheEndOfAFrame) {
  SchedulerStage stage;
  stage.AddJob(1, 0, 2);  // 16 units each
  stage.Join(1, 12);
  stage.Advance();
  std::set<uint32_t> frames;
  for (const Lease& lease : stage.Held(1)) frames.insert(lease.unit.frame);
  EXPECT_EQ(stage.Held(1).size(), 24u);
  EXPECT_EQ(frames, (std::set<uint32_t>{0, 1}));
}

TEST(SchedulerFrames, FramesThatLoadLongerThanTheyRenderAreDividedAmongTheWorkers) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1, 0, 16);
  constexpr uint64_t kWorkers = 5;
  for (uint64_t w = 1; w <= kWorkers; ++w) {
    stage.Worker(w);
    stage.Send(w);
  }
  std::map<uint32_t, std::set<uint64_t>> loaded;  // by frame: who
  for (int round = 0; round < 60; ++round) {
    stage.Advance();
    for (uint64_t w = 1; w <= kWorkers; ++w) {
      for (const SceneRequest& order : stage.told[w].scenes) loaded[FrameOf(stage, job, order.key)].insert(w);
    }
    LoadScenes(stage, kWorkers, std::chrono::seconds(2));
    for (int i = 0; i < 20; ++i) {
      for (uint64_t w = 1; w <= kWorkers; ++w) stage.FinishAll(w, 0.01);
      stage.Advance();
    }
  }
  size_t loads = 0;
  for (const auto& [frame, workers] : loaded) loads += workers.size();
  EXPECT_EQ(loaded.size(), 16u);
  EXPECT_LE(loads, 16u * 3) << "of 80, if every worker loaded every frame";
  for (uint32_t f = 0; f < 16; ++f) EXPECT_TRUE(stage.IsComplete(job, f)) << f;
}

TEST(SchedulerFrames, NoMoreFramesAreBegunThanTheLimit) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1, 0, 100);
  stage.Join(1, 512);
  stage.Advance();
  uint32_t last = 0;
  for (const Lease& lease : stage.Held(1)) last = std::max(last, lease.unit.frame);
  EXPECT_LT(last, kFramesActiveMax);
  EXPECT_FALSE(stage.IsComplete(job, 99));
}

// Tiles 10, 11, 14 and 15.
TEST(SchedulerFrames, ARegionThatGoesFirstIsLeasedUntilItIsDoneAndThenTheRestIs) {
  SchedulerStage stage;
  stage.first = Region{0.5f, 1, 0.5f, 1};
  const JobId job = stage.AddJob(16);
  stage.Join(1, 2);
  std::vector<uint32_t> tiles;
  for (int round = 0; round < 1000 && !stage.IsComplete(job, 0); ++round) {
    stage.Advance(milliseconds(100));
    for (const Lease& lease : stage.Held(1)) {
      tiles.push_back(lease.unit.tile);
      stage.Finish(1, lease, 10.0 * lease.unit.range.size);
    }
    stage.Send(1);
  }
  ASSERT_TRUE(stage.IsComplete(job, 0));
  const std::set<uint32_t> region{10, 11, 14, 15};
  const auto is_first = [&](uint32_t tile) { return region.contains(tile); };
  EXPECT_TRUE(std::ranges::is_partitioned(tiles, is_first));
  EXPECT_EQ(std::set<uint32_t>(tiles.begin(), tiles.end()).size(), 16u);
}

}  // namespace
}  // namespace tessera
