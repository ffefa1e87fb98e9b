// Verified jobs from the first vote to the picture, and what survives a restart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/farm_stage.h"

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr SampleRange kAll{0, 4};

std::shared_ptr<JobSpec> VerifiedJob(uint64_t submission, double share = 1) {
  auto spec = SmallJob(submission);
  spec->verify_share = share;
  return spec;
}

RadianceTile Wrong(SampleRange range) {
  RadianceTile tile = Ones(range);
  tile.sums[17] += 1;
  return tile;
}

struct VerifiedStage : FarmStage {
  Verdict Say(JobId job, uint64_t worker, Result<RadianceTile> tile, SampleRange range = kAll) {
    return Return(job, range, std::move(tile), 0, 0, worker);
  }
};

TEST(FarmVerification, AResultIsMergedWhenASecondWorkerReturnsTheSame) {
  VerifiedStage stage;
  const JobId job = *stage.farm.Submit(stage.now, VerifiedJob(1));
  EXPECT_EQ(stage.Say(job, 1, Ones(kAll)), Verdict::kAccepted);
  EXPECT_EQ(stage.Status(job).samples_done, 0u);
  EXPECT_EQ(stage.Say(job, 1, Ones(kAll)), Verdict::kDuplicate);
  EXPECT_EQ(stage.Say(job, 2, Ones(kAll)), Verdict::kAccepted);
  ASSERT_EQ(stage.output.pictures.size(), 1u);
  EXPECT_EQ(stage.output.pictures[0].snapshot.Picture().values, std::vector<float>(64, 1.0f));
  EXPECT_EQ(stage.Status(job).units_verified, 1u);
  EXPECT_EQ(stage.Status(job).units_disputed, 0u);
}

TEST(FarmVerification, AWrongResultNeverReachesThePictureAndItsWorkerIsNoLongerTrusted) {
  VerifiedStage stage;
  const JobId job = *stage.farm.Submit(stage.now, VerifiedJob(1));
  const JobId other = *stage.farm.Submit(stage.now, SmallJob(2));
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    stage.farm.Synchronize(stage.now, CallId{100 + worker}, stage.Worker(worker));
  }
  EXPECT_EQ(stage.Say(job, 1, Wrong(kAll)), Verdict::kAccepted);
  EXPECT_EQ(stage.Say(job, 2, Ones(kAll)), Verdict::kAccepted);
  EXPECT_EQ(stage.Status(job).units_disputed, 1u);
  EXPECT_TRUE(stage.output.pictures.empty());
  EXPECT_EQ(stage.Say(job, 3, Ones(kAll)), Verdict::kAccepted);
  ASSERT_EQ(stage.output.pictures.size(), 1u);
  EXPECT_EQ(stage.output.pictures[0].snapshot.Picture().values, std::vector<float>(64, 1.0f));
  EXPECT_EQ(stage.Status(job).units_verified, 1u);
  EXPECT_EQ(stage.Say(other, 1, Ones(kAll)), Verdict::kRefused);
  EXPECT_THAT(stage.reason, HasSubstr("quarantine"));
}

TEST(FarmVerification, UnitsOfADistrustedWorkerThatAreInThePictureAreReported) {
  VerifiedStage stage;
  // A share and a submission for which exactly one of the two halves is verified.
  uint64_t submission = 1;
  const auto chosen = [&](SampleRange range) {
    return Verification(0.5, Hash(submission, 0)).IsChosen({0, range});
  };
  while (chosen({0, 2}) || !chosen({2, 2})) ++submission;
  const JobId job = *stage.farm.Submit(stage.now, VerifiedJob(submission, 0.5));
  EXPECT_EQ(stage.Say(job, 1, Wrong({0, 2}), {0, 2}), Verdict::kAccepted);
  EXPECT_EQ(stage.Status(job).samples_done, 128u) << "it is not among those that are verified";
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    stage.Say(job, worker, worker == 1 ? Wrong({2, 2}) : Ones({2, 2}), {2, 2});
  }
  EXPECT_EQ(stage.Status(job).units_suspect, 1u);
  EXPECT_THAT(stage.output.log, testing::Contains(HasSubstr("results_suspect job=1")));

  FarmStage after;
  for (const std::string& fact : stage.facts) after.farm.Restore(*DecodeFact(fact));
  after.farm.Begin(after.now);
  EXPECT_EQ(after.Status(job).units_suspect, 1u);
  EXPECT_EQ(after.Status(job).units_verified, 1u);
  EXPECT_EQ(after.Status(job).units_disputed, 1u);
}

TEST(FarmVerification, VotesAndQuarantinesSurviveARestart) {
  VerifiedStage before;
  const JobId half = *before.farm.Submit(before.now, VerifiedJob(1));
  const JobId disputed = *before.farm.Submit(before.now, VerifiedJob(2));
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    before.farm.Synchronize(before.now, CallId{100 + worker}, before.Worker(worker));
  }
  EXPECT_EQ(before.Say(half, 2, Ones(kAll)), Verdict::kAccepted);
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    before.Say(disputed, worker, worker == 1 ? Wrong(kAll) : Ones(kAll));
  }

  VerifiedStage after;
  for (const std::string& fact : before.facts) after.farm.Restore(*DecodeFact(fact));
  after.farm.Begin(after.now);
  EXPECT_EQ(after.Say(half, 2, Ones(kAll)), Verdict::kDuplicate) << "it has said so before";
  EXPECT_EQ(after.Say(half, 1, Ones(kAll)), Verdict::kRefused) << "it is still in quarantine";
  EXPECT_EQ(after.Say(half, 3, Ones(kAll)), Verdict::kAccepted);
  EXPECT_EQ(after.output.pictures.size(), 1u);
}

TEST(FarmVerification, ASnapshotLeadsToTheSameStateAsTheFacts) {
  VerifiedStage before;
  const JobId half = *before.farm.Submit(before.now, VerifiedJob(1));
  const JobId disputed = *before.farm.Submit(before.now, VerifiedJob(2));
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    before.farm.Synchronize(before.now, CallId{100 + worker}, before.Worker(worker));
  }
  EXPECT_EQ(before.Say(half, 2, Ones(kAll)), Verdict::kAccepted);
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    before.Say(disputed, worker, worker == 1 ? Wrong(kAll) : Ones(kAll));
  }
  ASSERT_TRUE(before.farm.SetPaused(before.now, half, true));
  ASSERT_TRUE(before.farm.SetPriority(before.now, half, 7));

  VerifiedStage after;
  for (const Fact& fact : before.farm.Snapshot()) after.farm.Restore(*DecodeFact(EncodeFact(fact)));
  after.farm.Begin(after.now);
  EXPECT_TRUE(after.Status(half).paused_by_user);
  EXPECT_EQ(after.Status(half).priority, 7);
  EXPECT_EQ(after.Status(disputed).units_verified, 1u);
  EXPECT_EQ(after.Status(disputed).units_disputed, 1u);
  EXPECT_EQ(after.Say(half, 1, Ones(kAll)), Verdict::kRefused);
  EXPECT_EQ(after.Say(half, 3, Ones(kAll)), Verdict::kAccepted);
  EXPECT_EQ(after.output.pictures.size(), 1u);
}

TEST(FarmVerification, WorkersAreFoundByNameAndById) {
  FarmStage stage;
  for (uint64_t id = 1; id <= 3; ++id) {
    WorkerState worker = stage.Worker(id);
    worker.name = id == 3 ? "other" : "same";
    stage.farm.Synchronize(stage.now, CallId{100 + id}, worker);
  }
  EXPECT_EQ(stage.farm.FindWorkers(stage.now, "same").size(), 2u);
  EXPECT_EQ(stage.farm.FindWorkers(stage.now, "0000000000000002").size(), 1u);
  EXPECT_TRUE(stage.farm.FindWorkers(stage.now, "nobody").empty());
  stage.farm.Drain(WorkerId{3});
  stage.Step();
  ASSERT_EQ(stage.output.facts.size(), 2u) << "the process began, and a worker is drained";
  EXPECT_TRUE(std::get<WorkerQuarantined>(stage.output.facts[1]).drained);
}

}  // namespace
}  // namespace tessera
