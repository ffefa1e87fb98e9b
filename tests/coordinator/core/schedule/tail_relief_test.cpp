#include "coordinator/core/schedule/tail_relief.h"

#include <gtest/gtest.h>

#include "coordinator/core/schedule/policy.h"
#include "tests/coordinator/core/schedule/job_stage.h"

namespace tessera {
namespace {

// One job whose last unit is held by a slow worker, and a fast one without work.
struct TailStage {
  TailStage() : frame(job.Begin(0)) {
    state.jobs.Add(job);
    frame.work.RecordCost({0, {0, 1}}, 1.0 / 64);  // 64 samples take a second at speed 1
    slow = &Join(1);
    slow->speed = 0.1;
    fast = &Join(2);
    state.idle.Block(fast->id);
  }
  WorkerRecord& Join(uint64_t id) {
    WorkerState worker;
    worker.worker = WorkerId{id};
    worker.slots = 1;
    WorkerRecord& record = *state.workers.Admit(now, worker).first;
    record.scenes[frame.scene.key] = true;
    state.workers.UpdateTotals(record);
    return record;
  }
  LeaseId Grant(WorkerRecord& worker, uint32_t tile) {
    EXPECT_TRUE(frame.work.TakeExactly({tile, {0, 64}}));
    const LeaseId id = state.leases.NextId();
    leases.Grant(now, worker, job, frame, {job.id, 0, tile, {0, 64}}, id).is_announced = true;
    return id;
  }
  std::vector<SampleRange> RangesOf(const WorkerRecord& worker) const {
    std::vector<SampleRange> ranges;
    for (const LeaseId id : state.leases.OfWorker(worker.id))
      ranges.push_back(state.leases.At(id).lease.unit.range);
    return ranges;
  }
  JobStage jobs;
  Job& job = jobs.Make(1, 64);
  ActiveFrame& frame;
  ScheduleState state{1, 1};
  LeaseControl leases{state};
  TailRelief tail{state, leases};
  Instant now = seconds(100);
  WorkerRecord *slow = nullptr, *fast = nullptr;
};

TEST(TailRelief, AUnitThatWaitsAtASlowWorkerIsMoved) {
  TailStage stage;
  const LeaseId running = stage.Grant(*stage.slow, 0);
  const LeaseId waiting = stage.Grant(*stage.slow, 1);
  stage.tail.Relieve(stage.now);
  EXPECT_FALSE(stage.state.leases.Has(waiting));
  EXPECT_TRUE(stage.slow->revoked.contains(waiting));
  EXPECT_EQ(stage.RangesOf(*stage.fast), (std::vector<SampleRange>{{0, 64}}));
  EXPECT_TRUE(stage.state.leases.Has(running));
}

TEST(TailRelief, AUnitThatRunsAtASlowWorkerIsRenderedASecondTime) {
  TailStage stage;
  const LeaseId running = stage.Grant(*stage.slow, 0);
  stage.tail.Relieve(stage.now);
  EXPECT_TRUE(stage.state.leases.Has(running)) << "whichever ends first counts";
  EXPECT_EQ(stage.RangesOf(*stage.fast), (std::vector<SampleRange>{{0, 64}}));
}

TEST(TailRelief, NothingIsMovedThatWouldNotEndSooner) {
  TailStage stage;
  stage.slow->speed = 1;
  stage.Grant(*stage.slow, 0);
  stage.tail.Relieve(stage.now);
  EXPECT_TRUE(stage.RangesOf(*stage.fast).empty());
}

TEST(TailRelief, AWorkerThatFailedTheTileGetsNoPartOfIt) {
  TailStage stage;
  stage.Grant(*stage.slow, 0);
  stage.frame.failures.Record({TileSamples{0, {0, 64}}, stage.fast->id, {}, "fast: no luck"});
  stage.tail.Relieve(stage.now);
  EXPECT_TRUE(stage.RangesOf(*stage.fast).empty());
}

}  // namespace
}  // namespace tessera
