// The end of a job: idle workers relieve slower ones.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;

TEST(SchedulerTail, AUnitThatWaitsAtASlowerWorkerIsMoved) {
  SchedulerStage stage;
  stage.AddJob(1);
  stage.Join(1, 8);  // one unit runs and one waits for each slot
  stage.Advance();
  ASSERT_EQ(stage.Held(1).size(), 16u);
  stage.Join(2, 2);
  stage.Advance(milliseconds(60));
  ASSERT_EQ(stage.Held(2).size(), 2u);
  EXPECT_EQ(stage.dropped[1].size(), 2u) << "taken away, not copied";
  EXPECT_EQ(stage.scheduler.lease_count(), 16u);
}

TEST(SchedulerTail, ALateUnitIsRenderedTwiceAndTheLoserIsStopped) {
  SchedulerStage stage;
  stage.AddJob(1);
  stage.Join(1, 1);
  stage.Join(2, 15);
  stage.Advance();
  ASSERT_EQ(stage.Held(1).size(), 1u);
  const Lease late = stage.Held(1)[0];
  stage.FinishAll(2, 0.1);
  stage.Advance(milliseconds(60));
  EXPECT_TRUE(stage.Held(2).empty()) << "it is not late yet";
  stage.Send(1);
  stage.Send(2);
  stage.Advance(milliseconds(2500));
  ASSERT_EQ(stage.Held(2).size(), 1u);
  EXPECT_EQ(stage.Held(2)[0].unit, late.unit);
  stage.Send(1);
  stage.Send(2);
  stage.Join(3, 4);
  stage.Advance(milliseconds(2500));
  EXPECT_TRUE(stage.Held(3).empty()) << "two holders are enough";
  EXPECT_TRUE(stage.Finish(2, stage.Held(2)[0], 0.1));
  stage.Advance();
  EXPECT_EQ(stage.dropped[1], std::vector{late.id});
  EXPECT_TRUE(stage.IsComplete(JobId{1}, 0));
}

TEST(SchedulerTail, AStragglersRangeIsSplitAmongManyIdleSlots) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Worker(1);
  stage.HaveScene(1, job);
  WorkerState state = stage.states[1];
  // Worker 1 holds samples 32 to 64 of tile 0, from a former coordinator; all else is done, at 0.1 s per
  // sample.
  state.leases = {
      {FormerLease(5), {job, 0, 0, {32, 32}, stage.SceneOf(job)}, LeaseStage::kRunning, milliseconds(0)}};
  state.sequence = 1;
  stage.scheduler.Synchronize(stage.now, state);
  const auto unit = [&](uint32_t tile, SampleRange range) {
    return WorkUnit{job, 0, tile, range, stage.SceneOf(job)};
  };
  for (uint32_t tile = 0; tile < 16; ++tile) {
    stage.scheduler.Finish(stage.now, WorkerId{1}, LeaseId{}, unit(tile, {0, 32}), 3.2);
    if (tile > 0) stage.scheduler.Finish(stage.now, WorkerId{1}, LeaseId{}, unit(tile, {32, 32}), 3.2);
  }
  stage.Join(2, 4);
  for (int i = 0; i < 20; ++i) {
    stage.Advance(milliseconds(500));
    ++state.sequence;
    state.leases[0].stage_duration += milliseconds(500);
    stage.scheduler.Synchronize(stage.now, state);
    stage.Send(2);
  }
  SampleSet covered;
  for (const Lease& lease : stage.Held(2)) {
    EXPECT_FALSE(covered.Overlaps(lease.unit.range)) << "no sample has three holders";
    covered.Add(lease.unit.range);
  }
  EXPECT_EQ(stage.Held(2).size(), 4u);
  EXPECT_TRUE(covered.Contains({32, 32})) << "all pieces are handed out";
  for (const Lease& lease : stage.Held(2)) stage.Finish(2, lease, 0.8);
  stage.Advance();
  EXPECT_EQ(stage.dropped[1], std::vector{FormerLease(5)}) << "the straggler stops";
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerTail, WorkersOnTimeAreLeftAlone) {
  SchedulerStage stage;
  stage.AddJob(1);
  stage.Join(1, 8);
  stage.Join(2, 8);
  stage.Advance();
  const auto slow = stage.Held(1);
  for (const Lease& lease : stage.Held(2)) stage.Finish(2, lease, 0.5);
  for (int i = 0; i < 9; ++i) stage.Advance(milliseconds(50));
  EXPECT_TRUE(stage.Held(2).empty());
}

}  // namespace
}  // namespace tessera
