// What survives a coordinator process: jobs by their facts, results by their nodes in the spool.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/recovery_stage.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Whatever the moment of the crash: what was accepted is there, nothing of it is asked for again, and the
// rest makes the same picture.
TEST(FarmRecovery, EveryCrashPointLeadsToTheSamePicture) {
  constexpr uint32_t kSamples = 13;
  const FramePicture wanted = Reference(ExtendableJob(kSamples)->frames[0].spec, 0);
  std::vector<std::pair<uint32_t, SampleRange>> units;
  for (uint32_t tile = 0; tile < kTiles; ++tile) {
    for (const SampleRange range : {SampleRange{8, 4}, {0, 2}, {4, 4}, {12, 1}, {2, 2}})
      units.emplace_back(tile, range);
  }
  for (size_t crash = 0; crash <= units.size(); ++crash) {
    Disk disk;
    JobId job{};
    {
      Process before(disk);
      job = *before.farm.Submit(before.now, ExtendableJob(kSamples));
      before.Step();
      for (size_t u = 0; u < crash; ++u) {
        EXPECT_EQ(before.Return(job, 0, units[u].first, units[u].second), Verdict::kAccepted);
      }
    }
    Process after(disk);
    uint64_t restored = 0;
    for (size_t u = 0; u < crash; ++u) restored += 4 * units[u].second.size;
    EXPECT_EQ(after.Status(job).samples_done, restored);
    EXPECT_THAT(after.log, testing::Contains(HasSubstr("samples_restored=" + std::to_string(restored))));
    for (size_t u = 0; u < units.size(); ++u) {
      EXPECT_EQ(after.Return(job, 0, units[u].first, units[u].second),
                u < crash ? Verdict::kDuplicate : Verdict::kAccepted)
          << crash << " " << u;
    }
    ASSERT_EQ(after.pictures.size(), 1u) << crash;
    EXPECT_EQ(after.pictures[0].snapshot.Picture().values, wanted.values) << crash;
  }
}

TEST(FarmRecovery, TilesOfAnAdaptiveFrameStopAfterARestartWhereTheyWouldHave) {
  auto spec = ExtendableJob(128);
  spec->frames[0].spec.SetNoiseThreshold(0.2);
  Merger wanted(spec->frames[0].spec);
  struct Unit {
    uint32_t tile;
    SampleRange range;
    PixelMask pixels;
  };
  std::vector<Unit> units;  // doubling by doubling
  while (!wanted.Complete()) {
    for (uint32_t tile = 0; tile < kTiles; ++tile) {
      const PixelMask pixels = wanted.Goal(static_cast<int>(tile)).pixels;
      for (const SampleRange range : wanted.Missing(static_cast<int>(tile))) {
        units.push_back({tile, range, pixels});
        ASSERT_TRUE(wanted.Add(static_cast<int>(tile), Rendered(wanted.spec(), 0, tile, range, pixels)));
      }
    }
  }
  std::set<uint32_t> stops;
  for (int tile = 0; tile < kTiles; ++tile) stops.insert(wanted.Goal(tile).samples);
  ASSERT_GT(stops.size(), 1u) << "the tiles do not differ: choose another threshold";
  for (size_t crash = 0; crash <= units.size(); ++crash) {
    Disk disk;
    JobId job{};
    {
      Process before(disk);
      job = *before.farm.Submit(before.now, spec);
      before.Step();
      for (size_t u = 0; u < crash; ++u) {
        ASSERT_EQ(before.Return(job, 0, units[u].tile, units[u].range, units[u].pixels), Verdict::kAccepted);
      }
    }
    Process after(disk);
    uint64_t restored = 0;
    for (size_t u = 0; u < crash; ++u) restored += units[u].pixels.Count(4) * units[u].range.size;
    EXPECT_EQ(after.Status(job).samples_done, restored);
    for (size_t u = 0; u < units.size(); ++u) {
      EXPECT_EQ(after.Return(job, 0, units[u].tile, units[u].range, units[u].pixels),
                u < crash ? Verdict::kDuplicate : Verdict::kAccepted)
          << crash << " " << u;
    }
    EXPECT_EQ(after.Status(job).samples_total, wanted.samples_total()) << crash;
    ASSERT_EQ(after.pictures.size(), 1u) << crash;
    EXPECT_EQ(after.pictures[0].snapshot.Picture().values, wanted.Picture().values) << crash;
  }
}

// By the journal as it was written, and as it is written anew.
TEST(FarmRecovery, AFinishedAdaptiveFrameStillHasTheSamplesItWasMadeOf) {
  auto spec = ExtendableJob(128);
  spec->frames[0].spec.SetNoiseThreshold(1);
  Disk disk;
  JobId job{};
  JobStatus wanted;
  {
    Process process(disk);
    job = *process.farm.Submit(process.now, spec);
    process.Step();
    for (uint32_t tile = 0; tile < kTiles; ++tile) {
      for (const uint32_t begin : {0u, kDecisionSamplesMin / 2})
        process.Return(job, 0, tile, {begin, kDecisionSamplesMin / 2});
    }
    process.WritePictures();
    wanted = process.Status(job);
  }
  EXPECT_EQ(wanted.state, JobState::kFinished);
  EXPECT_EQ(wanted.samples_done, 16u * kDecisionSamplesMin);
  for (const char* journal : {"as it was", "anew"}) {
    Process process(disk);
    EXPECT_EQ(process.Status(job).state, JobState::kFinished) << journal;
    EXPECT_EQ(process.Status(job).samples_done, wanted.samples_done) << journal;
    EXPECT_EQ(process.Status(job).samples_total, wanted.samples_done) << journal;
    disk.facts.clear();
    for (const Fact& fact : process.farm.Snapshot()) disk.facts.push_back(EncodeFact(fact));
  }
}

TEST(FarmRecovery, NothingAcknowledgedIsLeasedAgain) {
  Disk disk;
  JobId job{};
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(8));
    before.Step();
    for (const uint32_t tile : {0u, 1u, 2u}) before.Return(job, 0, tile, {0, 8});
  }
  Process after(disk);
  WorkerState state;
  state.worker = WorkerId{5};
  state.sequence = 1;
  state.slots = 16;
  state.scenes = {{*after.farm.SceneOf({job, 0}), true}};
  after.farm.Synchronize(after.now, CallId{1}, state);
  after.farm.Advance(after.now);
  const FarmOutput output = after.farm.TakeOutput();
  ASSERT_EQ(output.directives.size(), 1u);
  ASSERT_FALSE(output.directives[0].directive.leases.empty());
  for (const Lease& lease : output.directives[0].directive.leases) EXPECT_EQ(lease.unit.tile, 3u);
}

TEST(FarmRecovery, APictureThatWasNotWrittenIsMadeFromTheSpool) {
  Disk disk;
  JobId job{};
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(8));
    before.Step();
    before.ReturnAll(job, 0, 0, 8);
    ASSERT_EQ(before.pictures.size(), 1u);
  }
  Process after(disk);
  ASSERT_EQ(after.pictures.size(), 1u);
  EXPECT_EQ(after.pictures[0].snapshot.Picture().values,
            Reference(ExtendableJob(8)->frames[0].spec, 0).values);
  after.WritePictures();
  EXPECT_EQ(after.Status(job).state, JobState::kFinished);
}

// The spool ignores what names another scene.
TEST(FarmRecovery, AFrameWhoseSpoolHasNothingForItIsRenderedAgain) {
  constexpr uint32_t kSamples = 5;
  Disk disk;
  JobId job{};
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(kSamples));
    before.Step();
    EXPECT_EQ(before.Return(job, 0, 0, {0, 4}), Verdict::kAccepted);
  }
  Process after(disk, kKeptBytesMaxDefault, Process::Contents::kIgnored);
  EXPECT_EQ(after.Status(job).samples_done, 0u);
  after.ReturnAll(job, 0, 0, kSamples);
  ASSERT_EQ(after.pictures.size(), 1u);
  EXPECT_EQ(after.pictures[0].snapshot.Picture().values,
            Reference(ExtendableJob(kSamples)->frames[0].spec, 0).values);
}

TEST(FarmRecovery, AFrameKeepsTheNameOfItsSceneThroughExtensionsAndRestarts) {
  Disk disk;
  JobId job{};
  std::optional<Digest> scene;
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(4));
    before.Step();
    scene = before.farm.SceneOf({job, 0});
    ASSERT_TRUE(before.farm.Extend(before.now, job, 16));
    before.Step();
    EXPECT_EQ(before.farm.SceneOf({job, 0}), scene);
  }
  ASSERT_TRUE(scene);
  Process after(disk);
  EXPECT_EQ(after.farm.SceneOf({job, 0}), scene);
  disk.facts.clear();
  for (const Fact& fact : after.farm.Snapshot()) disk.facts.push_back(EncodeFact(fact));
  Process compacted(disk);
  EXPECT_EQ(compacted.farm.SceneOf({job, 0}), scene);
  EXPECT_EQ(compacted.farm.SceneOf({job, 1}), std::nullopt);
  EXPECT_EQ(compacted.farm.SceneOf({JobId{99}, 0}), std::nullopt);
}

TEST(FarmRecovery, SpoolFramesOfEndedAndUnknownJobsAreDropped) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(8, 1, false));
  process.Step();
  process.Return(job, 0, 0, {0, 8});
  EXPECT_FALSE(disk.results.empty());
  ASSERT_TRUE(process.farm.Cancel(process.now, job));
  process.Step();
  EXPECT_TRUE(disk.results.empty());
  disk.results[{JobId{99}, 0}] = {{0, {0, 1}, {}}};  // of an unknown job
  const Process after(disk);
  EXPECT_TRUE(disk.results.empty());
}

TEST(FarmRecovery, WithoutKeptSumsFinishedFramesLeaveNothingInTheSpool) {
  Disk disk;
  Process process(disk, 0);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(8, 1, false));
  process.Step();
  process.Finish(job, 8);
  EXPECT_TRUE(disk.base.empty());
  EXPECT_TRUE(disk.results.empty());
  const auto extended = process.farm.Extend(process.now, job, 16);
  ASSERT_FALSE(extended);
  EXPECT_THAT(extended.error().message,
              testing::AllOf(HasSubstr("\"zsobol\""), HasSubstr("--spp 16"), HasSubstr("paddedsobol")));
}

TEST(FarmStorage, ADiskErrorIsShownByEveryOpenJobUntilItPasses) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4));
  process.farm.StorageDelayed("spool: no space left on device");
  EXPECT_EQ(process.Status(job).state, JobState::kPaused);
  EXPECT_EQ(process.Status(job).reason, "spool: no space left on device");
  process.farm.StorageDelayed("");
  EXPECT_EQ(process.Status(job).state, JobState::kWaiting);
}

// A disk on which the facts are those of a compacted journal.
void Compact(Process& process) {
  process.disk.facts.clear();
  for (const Fact& fact : process.farm.Snapshot()) process.disk.facts.push_back(EncodeFact(fact));
}

TEST(FarmRecovery, TheTimeOfAJobCountsFromItsSubmissionToItsEndWhateverIsRestarted) {
  for (const bool is_compacted : {false, true}) {
    Disk disk;
    disk.time_of_day = seconds(1'700'000'000);
    JobId job{};
    JobStatus ended;
    {
      Process first(disk);
      first.now += seconds(5);
      job = *first.farm.Submit(first.now, ExtendableJob(8));
      first.Step();
      first.now += seconds(10);
      EXPECT_EQ(first.Status(job).elapsed, seconds(10));
      if (is_compacted) Compact(first);
    }
    disk.time_of_day += seconds(65);
    {
      Process second(disk);
      EXPECT_EQ(second.Status(job).elapsed, seconds(60)) << "while no coordinator was there, too";
      second.now += seconds(30);
      second.Finish(job, 8);
      ended = second.Status(job);
      EXPECT_EQ(ended.elapsed, seconds(90));
      EXPECT_GT(ended.times.render_s, 0);
      if (is_compacted) Compact(second);
    }
    disk.time_of_day += seconds(1000);
    Process third(disk);
    third.now += seconds(7);
    const JobStatus restored = third.Status(job);
    EXPECT_EQ(restored.state, JobState::kFinished);
    EXPECT_EQ(restored.elapsed, seconds(90));
    EXPECT_DOUBLE_EQ(restored.samples_per_second, ended.samples_per_second);
    EXPECT_EQ(restored.times.render_s, ended.times.render_s);
    EXPECT_EQ(restored.times.overhead_s, ended.times.overhead_s);
  }
}

TEST(FarmRecovery, TheTimeBeforeAnExtensionDoesNotCount) {
  Disk disk;
  JobId job{};
  {
    Process first(disk);
    job = *first.farm.Submit(first.now, ExtendableJob(8));
    first.now += seconds(10);
    first.Finish(job, 8);
  }
  disk.time_of_day = seconds(500);
  {
    Process second(disk);
    ASSERT_TRUE(second.farm.Extend(second.now, job, 16));
    second.now += seconds(5);
    second.Step();
    EXPECT_EQ(second.Status(job).elapsed, seconds(15));
  }
  disk.time_of_day = seconds(520);
  Process third(disk);
  EXPECT_EQ(third.Status(job).elapsed, seconds(30));
}

TEST(FarmRecovery, AClockThatWasSetBackMakesNoTimeNegative) {
  Disk disk;
  disk.time_of_day = seconds(1000);
  JobId open{}, ended{};
  {
    Process before(disk);
    ended = *before.farm.Submit(before.now, ExtendableJob(8));
    before.now += seconds(10);
    before.Finish(ended, 8);
    auto another = ExtendableJob(8);
    another->submission = 2;
    open = *before.farm.Submit(before.now, another);
    before.Step();
  }
  disk.time_of_day = {};
  Process after(disk);
  EXPECT_EQ(after.Status(open).elapsed, seconds(0));
  EXPECT_EQ(after.Status(ended).elapsed, seconds(10));
}

TEST(FarmRecovery, JobsOfEarlierReleasesHaveNoTimesAndCountFromTheRestart) {
  Disk disk;
  JobId job{};
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(8));
    before.Step();
    std::erase_if(disk.facts, [](const std::string& fact) {
      return std::holds_alternative<JobTimed>(*DecodeFact(fact));
    });
  }
  disk.time_of_day = seconds(100);
  Process after(disk);
  after.now += seconds(3);
  EXPECT_EQ(after.Status(job).elapsed, seconds(3));
}

}  // namespace
}  // namespace tessera
