// What people are told about a job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/farm_stage.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Told {
  std::vector<std::string> texts;
  std::vector<MessageLevel> levels;
};

// A step of the farm, and what it tells.
Told Step(FarmStage& stage) {
  stage.Step();
  Told told;
  for (const JobMessage& message : stage.output.messages) {
    EXPECT_NE(message.submission, 0u) << message.text;
    told.texts.push_back(message.text);
    told.levels.push_back(message.level);
  }
  return told;
}

TEST(JobMessages, FollowAJobFromSubmissionToItsEnd) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1), {MemberId{5}, "ada"});
  EXPECT_THAT(Step(stage).texts, ElementsAre("submitted by ada: 1 frame, 4 samples per pixel, priority 0"));
  ASSERT_TRUE(stage.farm.SetPaused(stage.now, job, true));
  EXPECT_THAT(Step(stage).texts, ElementsAre("paused by the user"));
  ASSERT_TRUE(stage.farm.SetPaused(stage.now, job, false));
  ASSERT_TRUE(stage.farm.SetPriority(stage.now, job, 9));
  EXPECT_THAT(Step(stage).texts, ElementsAre("resumed", "priority 9"));
  stage.Return(job, {0, 4}, Ones({0, 4}));
  ASSERT_EQ(stage.output.messages.size(), 1u);
  EXPECT_EQ(stage.output.messages[0].text, "rendering");
  stage.farm.PictureDelayed(stage.now, {job, 0}, "No space left on device");
  const Told delayed = Step(stage);
  EXPECT_THAT(delayed.texts,
              ElementsAre("the picture of frame 0 cannot be written: No space left on device"));
  EXPECT_THAT(delayed.levels, ElementsAre(MessageLevel::kWarning));
  stage.farm.PictureNotDenoised({job, 0}, "not enough memory");
  stage.farm.PictureWritten(stage.now, {job, 0}, {Sha256("file"), 4});
  const Told end = Step(stage);
  EXPECT_THAT(end.texts,
              ElementsAre("frame 0 could not be denoised and its picture is noisy: not enough memory",
                          "frame 0 is finished", "finished"));
  EXPECT_EQ(stage.output.messages.back().change, JobMessage::Change::kEnds);
}

TEST(JobMessages, NameTheWorkerTheUnitAndTheReasonOfAFailure) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  stage.Step();
  const WorkUnit unit = stage.Unit(job, 0, 0, {0, 4});
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    JoinWithFormerLease(stage.farm, stage.now, CallId{++stage.calls}, WorkerId{worker}, unit);
    stage.farm.FailUnit(WorkerId{worker}, FormerLease(), unit, "out of memory");
    const Told told = Step(stage);
    ASSERT_FALSE(told.texts.empty());
    EXPECT_THAT(told.texts[0], HasSubstr("did not render tile 0 of frame 0, samples [0,4): out of memory"));
    EXPECT_EQ(told.levels[0], MessageLevel::kWarning);
    if (worker < 3) continue;
    EXPECT_THAT(told.texts.back(), testing::StartsWith("failed: a unit cannot be rendered"));
    EXPECT_EQ(told.levels.back(), MessageLevel::kError);
  }
}

TEST(JobMessages, TellWhichWorkerIsGoneAndWhatGoesBack) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  stage.Step();
  JoinWithFormerLease(stage.farm, stage.now, CallId{++stage.calls}, WorkerId{1},
                      stage.Unit(job, 0, 0, {0, 4}));
  stage.Step();
  stage.now += std::chrono::minutes(5);
  const Told told = Step(stage);
  ASSERT_FALSE(told.texts.empty());
  EXPECT_THAT(told.texts[0], HasSubstr("is gone; its 1 unit"));
}

TEST(JobMessages, AFullDiskIsToldToJobsWithResultsWhenItBeginsAndEnds) {
  FarmStage stage;
  const JobId job = *stage.farm.Submit(stage.now, SmallJob(1));
  const JobId other = *stage.farm.Submit(stage.now, SmallJob(2));
  stage.Return(job, {0, 2}, Ones({0, 2}));
  for (int i = 0; i < 3; ++i) stage.farm.StorageDelayed("No space left on device");
  const Told full = Step(stage);
  ASSERT_EQ(full.texts.size(), 1u) << "once, and not to jobs that wait all the same";
  EXPECT_EQ(stage.output.messages[0].job, job);
  EXPECT_NE(stage.output.messages[0].job, other);
  stage.farm.StorageDelayed("");
  EXPECT_THAT(Step(stage).texts, ElementsAre("the coordinator can write its data again"));
}

}  // namespace
}  // namespace tessera
