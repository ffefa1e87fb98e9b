// What is counted, and where a job's time went.
#include <gtest/gtest.h>

#include "coordinator/core/farm.h"
#include "tests/coordinator/core/former_lease.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kExact = 1e-9;

// A farm with one worker of two slots, and a job of one tile with 4 samples.
class ReportStage : public testing::Test {
 protected:
  ReportStage() {
    farm.Begin(now);
    spec->submission = 1;
    FrameSpec frame;
    frame.width = frame.height = 8;
    frame.crop = {0, 0, 8, 8};
    frame.tile_size = 8;
    frame.samples_per_pixel = 4;
    frame.channels = ColorsAndWeight({"R"});
    spec->frames = {{"scene", "", frame, 0}};
    worker.worker = WorkerId{1};
    worker.slots = 2;
    worker.wait = seconds(2);
  }
  void Step(Instant passed) {
    now += passed;
    farm.Advance(now);
    farm.TakeOutput();
  }
  void Say() {
    ++worker.sequence;
    farm.Synchronize(now, CallId{++calls}, worker);
  }
  void SetScene(bool ready, bool fetching) {
    worker.scenes = {{SceneKey(spec->package, "scene", "", spec->frames[0].spec), ready, fetching}};
    Say();
  }
  void Return(SampleRange range, double render_seconds) {
    RadianceTile tile{{0, 0, 8, 8}, range, {2}, {}};
    tile.sums.assign(128, static_cast<float>(range.size));
    farm.ReturnResults(now, CallId{++calls}, WorkerId{1},
                       {{FormerLease(), {job, 0, 0, range, *farm.SceneOf({job, 0})}, render_seconds, tile}});
  }
  JobTimes Times() const { return farm.Status(now, job)->times; }

  Instant now = seconds(100);
  Farm farm{SchedulerOptions{kLaterEpoch}};
  std::shared_ptr<JobSpec> spec = std::make_shared<JobSpec>();
  WorkerState worker;
  JobId job{};
  uint64_t calls = 0;
};

TEST_F(ReportStage, SlotTimeIsDividedByWhatTheWorkerDoes) {
  job = *farm.Submit(now, spec);
  Say();
  Step(seconds(0));
  Step(seconds(1));  // two idle slots
  SetScene(false, true);
  Step(seconds(0));
  Step(seconds(2));
  SetScene(false, false);
  Step(seconds(0));
  Step(seconds(3));
  const JobTimes times = Times();
  EXPECT_NEAR(times.idle_s, 2, kExact);
  EXPECT_NEAR(times.fetch_s, 4, kExact);
  EXPECT_NEAR(times.load_s, 6, kExact);
  EXPECT_NEAR(times.SlotSeconds(), 12, kExact);
  EXPECT_NEAR(farm.counters().slot_s, 12, kExact);
}

TEST_F(ReportStage, TheTailAndTheWritingOfPicturesAreReported) {
  job = *farm.Submit(now, spec);
  SetScene(true, false);
  Step(seconds(0));
  // Nothing is measured yet, so the units are small: the worker holds some, and no slot is without one.
  const double before = Times().SlotSeconds();
  EXPECT_EQ(before, 0);
  Return({0, 2}, 0.5);
  Return({2, 2}, 0.25);
  Step(seconds(0));  // all merged: both slots are idle while the picture is written
  Step(seconds(3));
  EXPECT_NEAR(Times().writing_s, 6, kExact);
  EXPECT_NEAR(Times().render_s, 0.75, kExact);
  farm.PictureWritten(now, {job, 0}, {Sha256("file"), 4});
  Step(seconds(0));
  Step(seconds(5));  // after the end nothing is added
  EXPECT_NEAR(Times().writing_s, 6, kExact);
  EXPECT_NEAR(Times().tail_s, 0, kExact);
}

TEST_F(ReportStage, DuplicatesAreCountedAsWaste) {
  job = *farm.Submit(now, spec);
  JoinWithFormerLease(farm, now, CallId{++calls}, WorkerId{1}, {job, 0, 0, {0, 2}, *farm.SceneOf({job, 0})});
  Return({0, 2}, 0.5);
  Return({0, 2}, 0.5);
  Step(seconds(0));
  EXPECT_EQ(farm.counters().units_accepted, 1u);
  EXPECT_EQ(farm.counters().units_duplicate, 1u);
  EXPECT_EQ(farm.counters().samples_accepted, 128u);
  EXPECT_EQ(farm.counters().samples_wasted, 128u);
  EXPECT_NEAR(Times().render_s, 0.5, kExact);
  EXPECT_NEAR(Times().waste_s, 0.5, kExact);
}

TEST_F(ReportStage, TheTimeOfALostWorkerIsWasteOfItsJob) {
  job = *farm.Submit(now, spec);
  SetScene(true, false);
  Step(seconds(0));
  EXPECT_GT(farm.counters().leases_granted, 0u);
  Step(seconds(1));
  farm.Cut(now, CallId{calls});  // its call is parked, so its end shows that the worker is gone
  Step(seconds(0));
  if (farm.counters().workers_lost == 0) {  // the call was answered before: it falls silent instead
    for (int s = 0; s < 30; ++s) Step(seconds(1));
  }
  EXPECT_EQ(farm.counters().workers_lost, 1u);
  EXPECT_GT(farm.counters().leases_retried, 0u);
  EXPECT_GE(Times().waste_s, 1.0);
  EXPECT_EQ(farm.scheduler().slot_use(), SlotUse{});
}

TEST_F(ReportStage, UtilisationCoversTheLastMinute) {
  Say();
  Step(seconds(10));
  worker.activity.busy_ms = 10'000;  // of 20,000
  Say();
  Step(seconds(0));
  EXPECT_NEAR(farm.Workers(now)[0].utilisation, 0.5, kExact);
  for (int i = 0; i < 30; ++i) {
    Step(seconds(5));
    worker.activity.busy_ms += 10'000;  // all of it
    Say();
  }
  Step(seconds(0));
  EXPECT_NEAR(farm.Workers(now)[0].utilisation, 1, kExact);
}

TEST_F(ReportStage, TheNoiseOfAJobIsKnownFromItsFirstDoublingOn) {
  job = *farm.Submit(now, spec);
  SetScene(true, false);
  Step(seconds(0));
  Return({0, 2}, 1);
  Step(seconds(1));
  EXPECT_FALSE(farm.Status(now, job)->noise);
  Return({2, 2}, 1);
  Step(seconds(1));
  ASSERT_TRUE(farm.Status(now, job)->noise) << "the frame is complete";
  EXPECT_EQ(*farm.Status(now, job)->noise, 0) << "all samples are equal";
}

TEST_F(ReportStage, WorkersShowTheirMemoryTheirScenesAndTheirLastFailure) {
  job = *farm.Submit(now, spec);
  worker.memory_bytes = 123'456'789;
  SetScene(true, false);
  Step(seconds(1));
  farm.FailScene(WorkerId{1}, Digest{}, "of a scene that it was not asked for");
  ASSERT_EQ(farm.Workers(now).size(), 1u);
  EXPECT_EQ(farm.Workers(now)[0].memory_bytes, 123'456'789u);
  EXPECT_EQ(farm.Workers(now)[0].scenes, std::vector<JobId>{job});
  EXPECT_EQ(farm.Workers(now)[0].last_failure, "");
  farm.FailScene(WorkerId{1}, SceneKey(spec->package, "scene", "", spec->frames[0].spec), "out of memory");
  EXPECT_EQ(farm.Workers(now)[0].last_failure, "out of memory");
  EXPECT_TRUE(farm.Workers(now)[0].scenes.empty());
}

}  // namespace
}  // namespace tessera
