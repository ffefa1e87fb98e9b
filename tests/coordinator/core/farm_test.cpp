// Jobs from submission to picture, without a network: what is accepted, refused, remembered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/probe.h"
#include "tests/coordinator/core/farm_stage.h"

namespace tessera {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

TEST(Farm, AJobGoesFromSubmissionToPicture) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  EXPECT_EQ(stage.Status(job).state, JobState::kWaiting);
  EXPECT_EQ(stage.Return(job, {2, 2}, Ones({2, 2})), Verdict::kAccepted);
  EXPECT_EQ(stage.Status(job).state, JobState::kRunning);
  EXPECT_EQ(stage.Status(job).samples_done, 128u);
  EXPECT_EQ(stage.Status(job).samples_total, 256u);
  WorkerState goodbye = stage.Worker(1);
  goodbye.leaving = true;
  stage.farm.Synchronize(stage.now, CallId{stage.calls}, goodbye);
  EXPECT_EQ(stage.Status(job).reason, "no worker is connected");
  EXPECT_EQ(stage.Return(job, {0, 2}, Ones({0, 2})), Verdict::kAccepted);
  EXPECT_EQ(stage.Status(job).reason, "") << "what is left to do needs no worker";
  ASSERT_EQ(stage.output.pictures.size(), 1u);
  EXPECT_EQ(stage.output.pictures[0].snapshot.Picture().values, std::vector<float>(64, 1.0f));
  EXPECT_FALSE(stage.farm.FinishedFile(job, 0));
  stage.farm.PictureWritten(stage.now, {job, 0}, {Sha256("file"), 4});
  stage.Step();
  EXPECT_EQ(stage.Status(job).state, JobState::kFinished);
  EXPECT_EQ(stage.farm.FinishedFile(job, 0), (PictureFile{Sha256("file"), 4}));
}

TEST(Farm, TheSameSubmissionIsTheSameJob) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(7));
  EXPECT_EQ(*stage.farm.Submit(stage.now, SmallJob(7)), job);
  EXPECT_NE(*stage.farm.Submit(stage.now, SmallJob(8)), job);
  EXPECT_EQ(stage.farm.Jobs(stage.now).size(), 2u);
}

TEST(Farm, WrongResultsAreRefusedWithTheirReason) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  RadianceTile wrong_bounds = Ones({0, 2});
  wrong_bounds.bounds = {0, 0, 8, 4};
  RadianceTile wrong_channels = Ones({0, 2});
  wrong_channels.shape = {4};
  const struct {
    Result<RadianceTile> tile;
    SampleRange range;
    uint32_t frame, tile_index;
    const char* reason;
  } table[] = {
      {Failed("its check sum is wrong"), {0, 2}, 0, 0, "its check sum is wrong"},
      {Ones({2, 2}), {0, 2}, 0, 0, "has samples [2,4), expected [0,2)"},
      {wrong_bounds, {0, 2}, 0, 0, "bounds of its tile"},
      {wrong_channels, {0, 2}, 0, 0, "4 channels, expected 2"},
      {Ones({0, 2}), {0, 2}, 0, 5, "no such unit"},
      {Ones({4, 4}), {4, 4}, 0, 0, "no such unit"},
  };
  for (const auto& row : table) {
    EXPECT_EQ(stage.Return(job, row.range, row.tile, row.frame, row.tile_index), Verdict::kRefused)
        << row.reason;
    EXPECT_THAT(stage.reason, HasSubstr(row.reason));
  }
  EXPECT_EQ(stage.Status(job).samples_done, 0u);
}

TEST(Farm, DuplicatesAreCountedOnceAndResultsOfEndedJobsAreObsolete) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1, 2));
  EXPECT_EQ(stage.Return(job, {0, 4}, Ones({0, 4})), Verdict::kAccepted);
  EXPECT_EQ(stage.Return(job, {0, 4}, Ones({0, 4})), Verdict::kDuplicate);
  EXPECT_EQ(stage.Return(job, {2, 1}, Ones({2, 1})), Verdict::kDuplicate);
  EXPECT_EQ(stage.Status(job).samples_done, 256u);
  EXPECT_EQ(stage.Return(JobId{99}, {0, 4}, Ones({0, 4})), Verdict::kObsolete);
  ASSERT_TRUE(stage.farm.Cancel(stage.now, job));
  EXPECT_EQ(stage.Return(job, {0, 4}, Ones({0, 4}), 1), Verdict::kObsolete);
  EXPECT_EQ(stage.Status(job).state, JobState::kCancelled);
}

TEST(Farm, CancellingAnEndedJobChangesNothing) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  stage.Return(job, {0, 4}, Ones({0, 4}));
  stage.farm.PictureWritten(stage.now, {job, 0}, {Sha256("file"), 4});
  EXPECT_EQ(stage.farm.Cancel(stage.now, job)->state, JobState::kFinished);
  EXPECT_FALSE(stage.farm.Cancel(stage.now, JobId{44}));
}

TEST(Farm, APictureThatCannotBeWrittenPausesItsJobUntilItIs) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  stage.Return(job, {0, 4}, Ones({0, 4}));
  stage.farm.PictureDelayed(stage.now, {job, 0}, "no space left");
  EXPECT_EQ(stage.Status(job).state, JobState::kPaused);
  EXPECT_EQ(stage.Status(job).reason, "the picture of frame 0 cannot be written: no space left");
  stage.farm.PictureWritten(stage.now, {job, 0}, {Sha256("file"), 4});
  EXPECT_EQ(stage.Status(job).state, JobState::kFinished);
}

TEST(Farm, JobsSurviveARestart) {
  FarmStage before;
  const JobId done = *before.farm.Submit(before.now, SmallJob(1));
  const JobId half = *before.farm.Submit(before.now, SmallJob(2, 2));
  const JobId cancelled = *before.farm.Submit(before.now, SmallJob(3));
  for (const JobId job : {done, half}) {
    EXPECT_EQ(before.Return(job, {0, 4}, Ones({0, 4})), Verdict::kAccepted);
    before.farm.PictureWritten(before.now, {job, 0}, {Sha256("file"), 4});
  }
  ASSERT_TRUE(before.farm.Cancel(before.now, cancelled));
  before.Step();

  FarmStage after;
  for (const std::string& fact : before.facts) after.farm.Restore(*DecodeFact(fact));
  after.farm.Begin(after.now);
  EXPECT_EQ(after.Status(done).state, JobState::kFinished);
  EXPECT_EQ(after.farm.FinishedFile(done, 0), (PictureFile{Sha256("file"), 4}));
  EXPECT_EQ(after.Status(cancelled).state, JobState::kCancelled);
  EXPECT_EQ(after.Status(half).frames_finished, 1u);
  EXPECT_EQ(after.Status(half).samples_done, 256u);
  EXPECT_EQ(after.Return(half, {0, 4}, Ones({0, 4})), Verdict::kDuplicate)
      << "its first frame is not rendered again";
  EXPECT_EQ(after.Return(half, {0, 4}, Ones({0, 4}), 1), Verdict::kAccepted);
  EXPECT_GT(*after.farm.Submit(after.now, SmallJob(4)), cancelled) << "numbers are never used twice";
  EXPECT_EQ(*after.farm.Submit(after.now, SmallJob(2)), half);
}

const JobOwner kAda{MemberId{5}, "ada"};

TEST(Farm, ASubmissionOfAnotherOwnerIsNotTheSameJob) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(7), kAda);
  EXPECT_EQ(*stage.farm.Submit(stage.now, SmallJob(7), {kAda.member, "renamed"}), job);
  const auto refused = stage.farm.Submit(stage.now, SmallJob(7), {MemberId{6}, "ada"});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("another owner"));
  EXPECT_FALSE(stage.farm.Submit(stage.now, SmallJob(7)));
  EXPECT_EQ(stage.farm.Jobs(stage.now).size(), 1u);
}

TEST(Farm, OwnersSurviveARestartAndACompactedJournal) {
  FarmStage before;
  const JobId owned = *before.farm.Submit(before.now, SmallJob(1), kAda);
  const JobId local = *before.farm.Submit(before.now, SmallJob(2), {{}, kLocalOwner});
  const JobId old = *before.farm.Submit(before.now, SmallJob(3));
  ASSERT_TRUE(before.farm.Cancel(before.now, owned));
  before.Step();
  FarmStage after, last;
  for (const std::string& fact : before.facts) after.farm.Restore(*DecodeFact(fact));
  after.farm.Begin(after.now);
  for (const Fact& fact : after.farm.Snapshot()) last.farm.Restore(*DecodeFact(EncodeFact(fact)));
  last.farm.Begin(last.now);
  for (const FarmStage* stage : {&before, &after, &last}) {
    EXPECT_EQ(*stage->farm.OwnerOf(owned), kAda);
    EXPECT_EQ(stage->Status(owned).owner, kAda);
    EXPECT_EQ(stage->Status(local).owner, (JobOwner{{}, kLocalOwner}));
    EXPECT_EQ(stage->Status(old).owner, JobOwner{});
    EXPECT_EQ(stage->farm.OwnerOf(JobId{99}), nullptr);
  }
}

// The end of a journal may be lost in a crash, wherever it is cut.
TEST(Farm, NoPrefixOfAJournalHasAJobWithoutItsOwner) {
  FarmStage before;
  const JobId first = *before.farm.Submit(before.now, SmallJob(1), kAda);
  before.Step();
  for (size_t size = 0; size <= before.facts.size(); ++size) {
    FarmStage after;
    for (size_t i = 0; i < size; ++i) after.farm.Restore(*DecodeFact(before.facts[i]));
    after.farm.Begin(after.now);
    if (const JobOwner* const owner = after.farm.OwnerOf(first)) {
      EXPECT_EQ(*owner, kAda);
    } else {
      const JobOwner next{MemberId{6}, "bob"};
      EXPECT_EQ(*after.farm.OwnerOf(*after.farm.Submit(after.now, SmallJob(2), next)), next);
    }
  }
}

TEST(Farm, APausedJobShowsItsReasonAndContinuesWhenResumed) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  EXPECT_EQ(stage.farm.SetPaused(stage.now, job, true)->state, JobState::kPaused);
  EXPECT_TRUE(stage.Status(job).paused_by_user);
  EXPECT_EQ(stage.Status(job).reason, "by the user");
  EXPECT_EQ(stage.Return(job, {0, 4}, Ones({0, 4})), Verdict::kAccepted) << "it was running";
  stage.farm.PictureDelayed(stage.now, {job, 0}, "no space left");
  EXPECT_EQ(stage.Status(job).reason, "by the user; the picture of frame 0 cannot be written: no space left");
  EXPECT_FALSE(stage.farm.SetPaused(stage.now, job, false)->paused_by_user);
  EXPECT_EQ(stage.Status(job).reason, "the picture of frame 0 cannot be written: no space left")
      << "the other cause is still there";
}

TEST(Farm, UnitsThatWereRunningWhenTheirJobWasPausedAreAccepted) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  ASSERT_TRUE(stage.farm.SetPaused(stage.now, job, true));
  EXPECT_EQ(stage.Return(job, {0, 4}, Ones({0, 4})), Verdict::kAccepted);
  EXPECT_EQ(stage.output.pictures.size(), 1u);
}

TEST(Farm, OnlyOpenJobsArePausedOrChanged) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  ASSERT_TRUE(stage.farm.Cancel(stage.now, job));
  EXPECT_THAT(stage.farm.SetPaused(stage.now, job, true).error().message,
              HasSubstr("is cancelled; it can no longer be paused"));
  EXPECT_THAT(stage.farm.SetPriority(stage.now, job, 3).error().message, HasSubstr("is cancelled"));
  EXPECT_THAT(stage.farm.SetPaused(stage.now, JobId{9}, true).error().message, HasSubstr("no job 9"));
}

TEST(Farm, PausesAndPrioritiesSurviveARestart) {
  FarmStage before;
  const JobId paused = *before.farm.Submit(before.now, SmallJob(1));
  const JobId resumed = *before.farm.Submit(before.now, SmallJob(2));
  for (const JobId job : {paused, resumed}) ASSERT_TRUE(before.farm.SetPaused(before.now, job, true));
  ASSERT_TRUE(before.farm.SetPaused(before.now, resumed, false));
  ASSERT_TRUE(before.farm.SetPaused(before.now, resumed, false));
  ASSERT_TRUE(before.farm.SetPriority(before.now, resumed, 7));
  before.Step();
  EXPECT_EQ(before.facts.size(), 1u + 2u * 2u + 3u + 1u) << "what changes nothing is no fact";

  FarmStage after;
  for (const std::string& fact : before.facts) after.farm.Restore(*DecodeFact(fact));
  after.farm.Begin(after.now);
  EXPECT_TRUE(after.Status(paused).paused_by_user);
  EXPECT_EQ(after.Status(resumed).state, JobState::kWaiting);
  EXPECT_EQ(after.Status(resumed).priority, 7);
  after.farm.Synchronize(after.now, CallId{1}, after.Worker(5));
  after.Step();
  ASSERT_EQ(after.output.directives.size(), 1u);
  ASSERT_EQ(after.output.directives[0].directive.scenes.size(), 1u);
  EXPECT_TRUE(after.farm.SetPaused(after.now, resumed, true));
}

TEST(Farm, AWaitingCallIsAnsweredImmediatelyWhenAJobIsSubmitted) {
  FarmStage stage;
  stage.farm.Synchronize(stage.now, CallId{1}, stage.Worker(5));
  stage.Step();
  EXPECT_TRUE(stage.output.directives.empty());
  ASSERT_TRUE(stage.farm.Submit(stage.now, SmallJob(1)));
  stage.Step();
  ASSERT_EQ(stage.output.directives.size(), 1u);
  EXPECT_EQ(stage.output.directives[0].call, CallId{1});
  EXPECT_EQ(stage.output.directives[0].directive.scenes.size(), 1u);
}

TEST(Farm, AWaitingCallIsAnsweredAfterItsWait) {
  FarmStage stage;
  stage.farm.Synchronize(stage.now, CallId{1}, stage.Worker(5));
  stage.Step();
  EXPECT_LE(stage.farm.Patience(stage.now), Instant(seconds(2)));
  stage.now += seconds(2);
  stage.Step();
  EXPECT_EQ(stage.output.directives.size(), 1u);
}

TEST(Farm, ANewerCallAnswersTheOlder) {
  FarmStage stage;
  stage.farm.Synchronize(stage.now, CallId{1}, stage.Worker(5));
  stage.farm.Synchronize(stage.now, CallId{2}, stage.Worker(5));
  stage.Step();
  ASSERT_EQ(stage.output.directives.size(), 1u);
  EXPECT_EQ(stage.output.directives[0].call, CallId{1});
  stage.farm.Cut(stage.now, CallId{1});
  EXPECT_EQ(stage.farm.Workers(stage.now).size(), 1u)
      << "the end of an old call is not the end of the worker";
  stage.farm.Cut(stage.now, CallId{2});
  EXPECT_EQ(stage.farm.Workers(stage.now).size(), 0u);
}

TEST(Farm, WorkersOfAnotherReleaseAreNotAdmitted) {
  const FarmStage stage;
  WorkerState state;
  state.software_version = "0.1.0";
  EXPECT_THAT(stage.farm.CheckAdmission(state).error().message,
              HasSubstr(std::string("has version 0.1.0, this coordinator ") + kSoftwareVersion +
                        "; install the same release on both"));
  state = {};
  state.protocol = 99;
  EXPECT_THAT(stage.farm.CheckAdmission(state).error().message, HasSubstr("protocol 99"));
}

TEST(Farm, AWorkerWithAnotherProbeDigestIsRefusedWithBothDigests) {
  FarmStage stage;
  WorkerState state;
  const auto bytes_of = [](const Digest& digest) {
    return std::string(digest.bytes.begin(), digest.bytes.end());
  };
  ASSERT_FALSE(stage.farm.CheckAdmission(state)) << "the probe is not optional";
  EXPECT_THAT(stage.farm.CheckAdmission(state).error().message, HasSubstr("has not rendered the probe unit"));
  state.probe_digest = bytes_of(*Digest::FromHex(kProbeDigest));
  EXPECT_TRUE(stage.farm.CheckAdmission(state));
  state.probe_digest = bytes_of(Sha256("another machine"));
  const auto refused = stage.farm.CheckAdmission(state);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr(Sha256("another machine").Hex()));
  EXPECT_THAT(refused.error().message, HasSubstr(std::string(kProbeDigest)));
}

TEST(Farm, APreviewShowsWhatIsThere) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  EXPECT_EQ(stage.farm.Preview(job, 0)->snapshot.Picture().values, std::vector<float>(64, 0.0f));
  stage.Return(job, {0, 1}, Ones({0, 1}));
  EXPECT_EQ(stage.farm.Preview(job, 0)->snapshot.Picture().values, std::vector<float>(64, 1.0f));
  EXPECT_FALSE(stage.farm.Preview(job, 1));
  EXPECT_FALSE(stage.farm.Preview(JobId{9}, 0));
}

// One tile without any noise: it stops at the first decision.
std::shared_ptr<JobSpec> AdaptiveJob(double threshold = 0.01) {
  auto spec = SmallJob(1);
  spec->frames[0].spec.samples_per_pixel = kDecisionSamplesMin * 4;
  spec->frames[0].spec.SetNoiseThreshold(threshold);
  return spec;
}

TEST(Farm, AnAdaptiveJobEndsWhenItsTilesHaveStopped) {
  constexpr uint32_t kHalf = kDecisionSamplesMin / 2;
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, AdaptiveJob());
  EXPECT_EQ(stage.Status(job).samples_total, kHalf * 8 * 64u);
  EXPECT_EQ(stage.Return(job, {kHalf, kHalf}, Ones({kHalf, kHalf}, 3)), Verdict::kAccepted);
  EXPECT_EQ(stage.Return(job, {0, kHalf}, Ones({0, kHalf}, 3)), Verdict::kAccepted);
  ASSERT_EQ(stage.output.pictures.size(), 1u);
  EXPECT_EQ(stage.output.pictures[0].snapshot.Picture().values, std::vector<float>(64, 1.0f));
  EXPECT_EQ(stage.Status(job).samples_done, kHalf * 2 * 64u);
  EXPECT_EQ(stage.Status(job).samples_total, kHalf * 2 * 64u) << "the progress reaches its end";
  EXPECT_EQ(stage.Return(job, {kHalf * 2, kHalf}, Ones({kHalf * 2, kHalf}, 3)), Verdict::kDuplicate);
}

TEST(Farm, AResultThatSpansADoublingIsNoUnitOfAnAdaptiveJob) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, AdaptiveJob());
  const SampleRange over{0, kDecisionSamplesMin};
  EXPECT_EQ(stage.Return(job, over, Ones(over, 3)), Verdict::kRefused);
  EXPECT_THAT(stage.reason, HasSubstr("no such unit"));
}

// It is not known yet of which pixels they are wanted, if of any.
TEST(Farm, AResultBeyondTheNextDecisionOfItsTileIsObsolete) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, AdaptiveJob());
  const SampleRange early{kDecisionSamplesMin * 2, kDecisionSamplesMin * 2};
  EXPECT_EQ(stage.Return(job, early, Ones(early, 3)), Verdict::kObsolete);
  EXPECT_EQ(stage.Status(job).samples_done, 0u);
}

TEST(Farm, AResultOfOtherPixelsThanRequestedIsRefused) {
  constexpr uint32_t kHalf = kDecisionSamplesMin / 2;
  FarmStage stage;
  const auto spec = AdaptiveJob(0.5);
  const JobId job = *stage.farm.Submit(stage.now, spec);
  // The upper rows differ from half to half.
  const auto halves = [](SampleRange range) {
    RadianceTile tile = Ones(range, 3);
    for (size_t p = 0; p < 24 && range.begin % kDecisionSamplesMin != 0; ++p) tile.sums[p * 3] *= 2;
    return tile;
  };
  RadianceTile missing = Ones({0, kHalf}, 3);
  std::fill_n(missing.sums.begin(), 3, 0.0f);
  EXPECT_EQ(stage.Return(job, {0, kHalf}, missing), Verdict::kRefused);
  EXPECT_THAT(stage.reason, HasSubstr("holds samples of other pixels than those requested"));
  Merger merger(spec->frames[0].spec);
  for (const SampleRange range : {SampleRange{0, kHalf}, SampleRange{kHalf, kHalf}}) {
    ASSERT_TRUE(merger.Add(0, halves(range)));
    EXPECT_EQ(stage.Return(job, range, halves(range), 0, 0, 2), Verdict::kAccepted);
  }
  const PixelMask pixels = merger.Goal(0).pixels;
  ASSERT_TRUE(pixels.Count(64) > 0 && pixels.Count(64) < 64) << pixels.Count(64);
  const SampleRange next{kDecisionSamplesMin, kDecisionSamplesMin};
  RadianceTile tile = halves(next);
  EXPECT_EQ(stage.Return(job, next, tile, 0, 0, 3), Verdict::kRefused);
  KeepPixels(pixels, tile);
  EXPECT_EQ(stage.Return(job, next, tile, 0, 0, 4), Verdict::kAccepted);
  EXPECT_EQ(stage.Status(job).samples_done, kDecisionSamplesMin * (64u + pixels.Count(64)));
}

}  // namespace
}  // namespace tessera
