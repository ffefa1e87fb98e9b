// More samples for running and finished jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/recovery_stage.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(FarmExtend, AFinishedJobContinuesFromItsSums) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(5));
  process.Step();
  process.Finish(job, 5);
  ASSERT_TRUE(process.farm.Extend(process.now, job, 19));
  process.Step();
  EXPECT_EQ(process.Status(job).state, JobState::kRunning);
  EXPECT_EQ(process.Status(job).samples_done, 16u * 5);
  EXPECT_EQ(process.Status(job).samples_total, 16u * 19);
  EXPECT_FALSE(process.farm.FinishedFile(job, 0));
  process.ReturnAll(job, 0, 5, 19);
  EXPECT_TRUE(process.pictures.empty()) << "its first samples are still in the spool";
  process.Load();
  ASSERT_EQ(process.pictures.size(), 1u);
  EXPECT_EQ(process.pictures[0].snapshot.Picture().values,
            Reference(ExtendableJob(19)->frames[0].spec, 0).values);
  EXPECT_EQ(process.pictures[0].spec->frames[0].spec, ExtendableJob(19)->frames[0].spec) << "header and all";
  process.WritePictures();
  EXPECT_EQ(process.Status(job).state, JobState::kFinished);
  EXPECT_EQ(process.Status(job).samples_done, 16u * 19);
}

TEST(FarmExtend, ARunningJobKeepsItsMergedSamples) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(8));
  process.Step();
  process.Return(job, 0, 0, {0, 8});
  process.Return(job, 0, 1, {4, 4});
  ASSERT_TRUE(process.farm.Extend(process.now, job, 16));
  process.Step();
  EXPECT_EQ(process.Return(job, 0, 0, {0, 8}), Verdict::kDuplicate);
  EXPECT_EQ(process.Return(job, 0, 1, {0, 4}), Verdict::kAccepted);
  EXPECT_EQ(process.Return(job, 0, 1, {8, 8}), Verdict::kAccepted);
  process.Return(job, 0, 0, {8, 8});
  process.Return(job, 0, 2, {0, 16});
  process.Return(job, 0, 3, {0, 16});
  ASSERT_EQ(process.pictures.size(), 1u);
  EXPECT_EQ(process.pictures[0].snapshot.Picture().values,
            Reference(ExtendableJob(16)->frames[0].spec, 0).values);
}

TEST(FarmExtend, AnAdaptiveJobIsRefused) {
  Disk disk;
  Process process(disk);
  auto spec = ExtendableJob(4);
  spec->frames[0].spec.SetNoiseThreshold(0.1);
  const JobId job = *process.farm.Submit(process.now, spec);
  process.Step();
  const auto extended = process.farm.Extend(process.now, job, 8);
  ASSERT_FALSE(extended);
  EXPECT_THAT(extended.error().message, HasSubstr("its pixels stop adaptively (--noise-threshold)"));
  EXPECT_THAT(extended.error().message, HasSubstr("submit the scene again with --spp 8"));
}

// Extension and compaction, in all stages of a job of two frames, survive.
TEST(FarmExtend, SurvivesARestartAtEveryStep) {
  const auto run = [](int restart_at, bool compact) {
    Disk disk;
    auto process = std::make_unique<Process>(disk);
    const JobId job = *process->farm.Submit(process->now, ExtendableJob(4, 2));
    process->Step();
    int step = 0;
    const auto maybe_restart = [&] {
      if (step++ != restart_at) return;
      if (compact) {
        disk.facts.clear();
        for (const Fact& fact : process->farm.Snapshot()) disk.facts.push_back(EncodeFact(fact));
      }
      process = std::make_unique<Process>(disk);
    };
    process->ReturnAll(job, 0, 0, 4);
    maybe_restart();
    process->ReturnAll(job, 1, 0, 4);
    process->WritePictures();
    process->pictures.clear();
    maybe_restart();
    ASSERT_TRUE(process->farm.Extend(process->now, job, 8)) << restart_at;
    process->Step();
    maybe_restart();
    process->Return(job, 0, 0, {4, 4});
    maybe_restart();
    process->ReturnAll(job, 0, 4, 8);
    process->Load();
    process->WritePictures();
    maybe_restart();
    ASSERT_TRUE(process->farm.Extend(process->now, job, 16)) << restart_at;
    process->Step();
    maybe_restart();
    process->pictures.clear();
    process->ReturnAll(job, 0, 8, 16);
    process->ReturnAll(job, 1, 4, 16);
    process->Load();
    maybe_restart();
    for (const FinishedPicture& each : process->pictures) {
      EXPECT_EQ(each.snapshot.Picture().values,
                Reference(ExtendableJob(16)->frames[0].spec, each.frame).values)
          << restart_at;
    }
    EXPECT_EQ(process->pictures.size(), 2u) << restart_at;
    process->WritePictures();
    EXPECT_EQ(process->Status(job).state, JobState::kFinished) << restart_at;
    EXPECT_EQ(process->Status(job).samples_done, process->Status(job).samples_total) << restart_at;
  };
  for (int restart_at = -1; restart_at < 7; ++restart_at) {
    run(restart_at, false);
    run(restart_at, true);
  }
}

TEST(FarmExtend, AnExtensionThatIsNotPossibleIsRefusedWithAReason) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(8));
  process.Step();
  process.Finish(job, 8);
  EXPECT_THAT(process.farm.Extend(process.now, job, 4).error().message,
              HasSubstr("8 samples per pixel already"));
  EXPECT_TRUE(process.farm.Extend(process.now, job, 8)) << "a request that is repeated";
  EXPECT_THAT(process.farm.Extend(process.now, JobId{9}, 4).error().message, HasSubstr("no job 9"));
}

TEST(FarmExtend, TheOldestSumsAreDroppedBeyondTheLimitOfBytes) {
  constexpr uint64_t kOneFrame = 16 * 2 * sizeof(float);
  Disk disk;
  Process process(disk, kOneFrame);
  std::vector<JobId> jobs;
  for (uint64_t submission : {1, 2}) {
    auto spec = ExtendableJob(8);
    spec->submission = submission;
    jobs.push_back(*process.farm.Submit(process.now, spec));
    process.Step();
    process.Finish(jobs.back(), 8);
  }
  EXPECT_EQ(disk.base.size(), 1u);
  EXPECT_THAT(process.farm.Extend(process.now, jobs[0], 16).error().message, HasSubstr("--sums-size"));
  EXPECT_TRUE(process.farm.Extend(process.now, jobs[1], 16));
  Disk copy = disk;
  Process after(copy, kOneFrame);
  EXPECT_FALSE(after.farm.Extend(after.now, jobs[0], 16));
  EXPECT_TRUE(after.farm.Extend(after.now, jobs[1], 16));
}

TEST(FarmExtend, SumsThatCannotBeReadBackFailTheJobWithThatReason) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4));
  process.Step();
  process.Finish(job, 4);
  ASSERT_TRUE(process.farm.Extend(process.now, job, 8));
  process.Step();
  process.Return(job, 0, 0, {4, 4});
  ASSERT_EQ(process.loads.size(), 1u);
  process.farm.SumsLoaded(process.now, process.loads[0], Failed("base-2: damaged at byte 7"));
  EXPECT_EQ(process.Status(job).state, JobState::kFailed);
  EXPECT_THAT(process.Status(job).reason, HasSubstr("base-2: damaged at byte 7"));
}

// The spool ignores what names another scene.
TEST(FarmExtend, SumsThatAreIncompleteFailTheJobAndNeverMakeAPicture) {
  for (const size_t missing : {size_t{1}, size_t{kTiles}}) {
    Disk disk;
    Process process(disk);
    const JobId job = *process.farm.Submit(process.now, ExtendableJob(5));
    process.Step();
    process.Finish(job, 5);
    ASSERT_TRUE(process.farm.Extend(process.now, job, 8));
    process.Step();
    process.Return(job, 0, 0, {5, 1});
    ASSERT_EQ(process.loads.size(), 1u);
    std::vector<TileNode> sums = disk.base[process.loads[0]];
    ASSERT_GE(sums.size(), missing);
    std::erase_if(sums, [&](const TileNode& node) { return node.tile < missing; });
    process.farm.SumsLoaded(process.now, process.loads[0], sums);
    process.Step();
    EXPECT_EQ(process.Status(job).state, JobState::kFailed);
    EXPECT_THAT(process.Status(job).reason, HasSubstr("some are missing"));
    process.ReturnAll(job, 0, 5, 8);
    EXPECT_TRUE(process.pictures.empty());
  }
}

}  // namespace
}  // namespace tessera
