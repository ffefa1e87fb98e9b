#include "coordinator/core/schedule/scene_locality.h"

#include <gtest/gtest.h>

#include "coordinator/core/schedule/policy.h"
#include "tests/coordinator/core/schedule/job_stage.h"

namespace tessera {
namespace {

struct LocalityStage {
  WorkerRecord& Join(uint64_t id) {
    WorkerState worker;
    worker.worker = WorkerId{id};
    worker.slots = 1;
    WorkerRecord& record = *state.workers.Admit(now, worker).first;
    state.workers.UpdateTotals(record);
    return record;
  }
  JobStage jobs;
  ScheduleState state{1, 1};
  SceneLocality scenes{state};
  Instant now = seconds(100);
};

TEST(SceneLocality, OneFrameIsRenderedAndTheNextOneLoaded) {
  LocalityStage stage;
  Job& job = stage.jobs.Make(1, 4, 0, 5);
  stage.state.jobs.Add(job);
  WorkerRecord& worker = stage.Join(1);
  stage.scenes.Activate(job);
  EXPECT_EQ(job.schedule.active.size(), 2u);
  EXPECT_EQ(stage.scenes.ReadyFrame(job, worker).frame, nullptr);
  FrameChoice load = stage.scenes.FrameToLoad(stage.now, job, worker);
  EXPECT_EQ(load.index, 0u);
  stage.scenes.Request(worker, load);
  EXPECT_TRUE(worker.wants(load.frame->scene.key));
  worker.scenes[load.frame->scene.key] = true;
  const FrameChoice ready = stage.scenes.ReadyFrame(job, worker);
  EXPECT_EQ(ready.index, 0u);
  stage.scenes.RequestNext(stage.now, worker, ready);
  EXPECT_TRUE(worker.wants(job.schedule.active.at(1).scene.key));
}

TEST(SceneLocality, FramesAreDividedWhereLoadingTakesLongerThanRendering) {
  LocalityStage stage;
  Job& job = stage.jobs.Make(1, 4, 0, 8);
  stage.state.jobs.Add(job);
  for (uint64_t w = 1; w <= 4; ++w) stage.Join(w);
  job.schedule.load_s = 40;
  job.schedule.measured_samples = 32 * 32 * 4;  // a frame costs 80 s: 20 s on this farm, half of the loading
  job.schedule.measured_cost = 80;
  stage.scenes.Activate(job);
  EXPECT_EQ(job.schedule.active.size(), 3u) << "two side by side and the next one";
  std::map<uint32_t, int> loads;
  for (auto& [id, worker] : stage.state.workers.all()) {
    const FrameChoice choice = stage.scenes.FrameToLoad(stage.now, job, worker);
    stage.scenes.Request(worker, choice);
    ++loads[choice.index];
  }
  EXPECT_EQ(loads, (std::map<uint32_t, int>{{0, 2}, {1, 2}}));
}

TEST(SceneLocality, ALoadThatWasRequestedIsMeasured) {
  LocalityStage stage;
  Job& job = stage.jobs.Make(1, 4);
  stage.state.jobs.Add(job);
  stage.scenes.Activate(job);
  WorkerRecord& worker = stage.Join(1);
  const Digest scene = job.schedule.active.at(0).scene.key;
  stage.scenes.MeasureLoading(stage.now, worker, scene);
  EXPECT_EQ(job.schedule.load_s, 0) << "nobody asked for it";
  worker.loading_since[scene] = stage.now;
  stage.scenes.MeasureLoading(stage.now + seconds(10), worker, scene);
  EXPECT_DOUBLE_EQ(job.schedule.load_s, 10);
}

}  // namespace
}  // namespace tessera
