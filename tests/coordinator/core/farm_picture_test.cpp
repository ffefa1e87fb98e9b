// Pictures that cannot be written, are damaged or are lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/recovery_stage.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct FarmPicture : testing::Test {
  JobId Submit(std::shared_ptr<JobSpec> spec) {
    spec->submission = ++submissions;
    const JobId job = *process.farm.Submit(process.now, spec);
    process.Step();
    return job;
  }
  void Delay(JobId job, uint32_t frame) {
    process.farm.PictureDelayed(process.now, {job, frame}, "no space left");
    process.Step();
    process.pictures.clear();
  }
  std::vector<float> Wanted(JobId job, uint32_t frame) {
    return Reference(process.farm.Spec(job)->frames[frame].spec, frame).values;
  }

  Disk disk;
  Process process{disk};
  uint64_t submissions = 0;
};

TEST_F(FarmPicture, ThatCannotBeWrittenIsMadeAgainLaterFromItsSums) {
  const JobId job = Submit(ExtendableJob(8, 1, false));
  process.ReturnAll(job, 0, 0, 8);
  Delay(job, 0);
  EXPECT_TRUE(process.loads.empty());
  process.now += seconds(2);
  process.Step();
  process.Load();
  ASSERT_EQ(process.pictures.size(), 1u);
  EXPECT_EQ(process.pictures[0].snapshot.Picture().values, Wanted(job, 0));
  process.WritePictures();
  EXPECT_EQ(process.Status(job).state, JobState::kFinished);
  EXPECT_EQ(process.Status(job).reason, "");
}

TEST_F(FarmPicture, ThatCannotBeWrittenDelaysNoOtherFrameAndItsReasonStays) {
  const JobId job = Submit(ExtendableJob(8, 2)), other = Submit(ExtendableJob(8));
  process.ReturnAll(job, 0, 0, 8);
  Delay(job, 0);
  process.ReturnAll(job, 1, 0, 8);
  process.ReturnAll(other, 0, 0, 8);
  ASSERT_EQ(process.pictures.size(), 2u);
  process.WritePictures();
  EXPECT_EQ(process.Status(other).state, JobState::kFinished);
  EXPECT_EQ(process.Status(job).frames_finished, 1u);
  EXPECT_EQ(process.Status(job).state, JobState::kPaused);
  EXPECT_EQ(process.Status(job).reason, "the picture of frame 0 cannot be written: no space left");
}

TEST_F(FarmPicture, ThatCannotBeWrittenIsForgottenWithItsJob) {
  const JobId job = Submit(ExtendableJob(8));
  process.ReturnAll(job, 0, 0, 8);
  Delay(job, 0);
  ASSERT_TRUE(process.farm.Cancel(process.now, job));
  EXPECT_FALSE(process.farm.IsMovingSums(job)) << "extend is answered, not put off";
  process.now += seconds(10);
  process.Step();
  EXPECT_TRUE(process.loads.empty());
  process.farm.PictureDelayed(process.now, {job, 0}, "no space left");
  EXPECT_EQ(process.Status(job).reason, "");
}

TEST(FarmPictures, BeyondTheLimitOfMemoryWaitInTheSpool) {
  Disk disk;
  auto spec = ExtendableJob(1, 3);
  const SharedSums sums = std::vector<float>(size_t{256} * 256 * 2, 1.0f);
  for (uint32_t f = 0; f < 3; ++f) {
    FrameSpec& frame = spec->frames[f].spec;
    frame.width = frame.height = 4096;
    frame.crop = {0, 0, 4096, 4096};
    frame.tile_size = 256;
    for (int tile = 0; tile < frame.TileCount(); ++tile)
      disk.results[{JobId{1}, f}].push_back({static_cast<uint32_t>(tile), {0, 1}, sums});
  }
  const uint64_t bytes = uint64_t{4096} * 4096 * 2 * sizeof(float);
  ASSERT_GT(3 * bytes, kPictureMemoryBytesMax);
  disk.facts.push_back(EncodeFact(JobSubmitted{JobId{1}, spec}));
  Process process(disk);
  EXPECT_EQ(process.pictures.size(), kPictureMemoryBytesMax / bytes);
  EXPECT_TRUE(process.loads.empty());
  process.WritePictures();
  process.pictures.clear();
  process.Load();
  EXPECT_EQ(process.pictures.size(), 1u);
  process.WritePictures();
  EXPECT_EQ(process.Status(JobId{1}).state, JobState::kFinished);
}

TEST_F(FarmPicture, ThatIsDamagedIsMadeAgainFromItsSums) {
  const JobId job = Submit(ExtendableJob(8, 1, false));
  process.Finish(job, 8);
  ASSERT_EQ(process.Status(job).state, JobState::kFinished);
  EXPECT_EQ(process.farm.PictureDamaged({job, 0}, "is corrupt"), std::nullopt);
  EXPECT_EQ(process.farm.PictureDamaged({job, 0}, "is corrupt"), std::nullopt) << "once";
  EXPECT_TRUE(process.farm.IsMovingSums(job));
  process.Step();
  ASSERT_EQ(process.loads.size(), 1u);
  process.Load();
  ASSERT_EQ(process.pictures.size(), 1u);
  EXPECT_EQ(process.pictures[0].snapshot.Picture().values, Wanted(job, 0));
  const size_t facts = disk.facts.size();
  process.WritePictures();
  EXPECT_EQ(disk.facts.size(), facts) << "nothing has changed";
  EXPECT_FALSE(process.farm.IsMovingSums(job));
  EXPECT_EQ(process.Status(job).reason, "");
  EXPECT_THAT(process.log, Contains(HasSubstr("picture_remade job=1 frame=0")));
}

TEST_F(FarmPicture, ThatIsMadeAgainWithOtherBytesIsJournalled) {
  const JobId job = Submit(ExtendableJob(8));
  process.Finish(job, 8);
  ASSERT_EQ(process.farm.PictureDamaged({job, 0}, "is missing"), std::nullopt);
  process.Step();
  process.Load();
  process.farm.PictureWritten(process.now, {job, 0}, {Sha256("of another encoder"), 5});
  process.Step();
  Process next(disk);
  EXPECT_EQ(next.farm.FinishedFile(job, 0), (PictureFile{Sha256("of another encoder"), 5}));
  EXPECT_EQ(next.farm.PictureDamaged({job, 0}, "is missing"), std::nullopt) << "its sums are still kept";
}

TEST_F(FarmPicture, WhoseSumsAreGoneIsLostAndTheJobSaysWhatToDo) {
  Process process(disk, 0);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(8));
  process.Step();
  process.Finish(job, 8);
  const auto lost = process.farm.PictureDamaged({job, 0}, "1/0.exr: is corrupt");
  ASSERT_TRUE(lost);
  EXPECT_THAT(*lost, HasSubstr("the picture of frame 0 is lost (1/0.exr: is corrupt)"));
  EXPECT_THAT(*lost, HasSubstr("submit the scene again"));
  EXPECT_EQ(process.Status(job).reason, *lost);
  process.farm.PictureIntact({job, 0});
  EXPECT_EQ(process.Status(job).reason, "") << "for example after its disk was mounted";
}

TEST_F(FarmPicture, WhoseSumsCannotBeReadIsLost) {
  const JobId job = Submit(ExtendableJob(8));
  process.Finish(job, 8);
  ASSERT_EQ(process.farm.PictureDamaged({job, 0}, "is corrupt"), std::nullopt);
  process.Step();
  process.farm.SumsLoaded(process.now, {job, 0}, Failed("base-1: damaged at byte 8"));
  EXPECT_EQ(process.Status(job).state, JobState::kFinished);
  EXPECT_THAT(process.Status(job).reason, HasSubstr("is lost (base-1: damaged at byte 8)"));
  EXPECT_FALSE(process.farm.IsMovingSums(job));
}

TEST_F(FarmPicture, KeptSumsMakeWayOldestFirst) {
  std::vector<FrameId> frames;
  for (int i = 0; i < 3; ++i) {
    const JobId job = Submit(ExtendableJob(8));
    process.Finish(job, 8);
    frames.push_back({job, 0});
  }
  ASSERT_EQ(process.farm.PictureDamaged(frames[0], "is corrupt"), std::nullopt);
  EXPECT_EQ(process.farm.GiveUpSums({frames[2]}), std::vector{frames[1]})
      << "the first is being used and the last is needed";
  EXPECT_TRUE(process.farm.PictureDamaged(frames[1], "is corrupt")) << "it is lost";
  EXPECT_EQ(process.farm.PictureDamaged(frames[2], "is corrupt"), std::nullopt);
}

}  // namespace
}  // namespace tessera
