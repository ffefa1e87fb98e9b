#include "coordinator/refused_pictures.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace tessera {
namespace {

using std::chrono::minutes;

const auto kStart = RefusedPictures::Clock::time_point();

FrameId Frame(uint64_t job, uint32_t frame = 0) {
  return {JobId{job}, frame};
}

EncodedPicture Bytes(size_t count) {
  return {std::string(count, 'x'), "why"};
}

const auto kSpec = std::make_shared<const JobSpec>();

TEST(RefusedPictures, ReturnsAPictureOnce) {
  RefusedPictures refused(100);
  EXPECT_FALSE(refused.Take(Frame(1), kSpec));
  refused.Keep(Frame(1), kSpec, Bytes(7), kStart);
  EXPECT_FALSE(refused.Take(Frame(1, 1), kSpec));
  const auto taken = refused.Take(Frame(1), kSpec);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->exr, "xxxxxxx");
  EXPECT_EQ(taken->denoise_failed, "why");
  EXPECT_EQ(refused.bytes(), 0u);
  EXPECT_FALSE(refused.Take(Frame(1), kSpec));
}

TEST(RefusedPictures, DropsThePictureOfAnEarlierSpecification) {
  RefusedPictures refused(100);
  refused.Keep(Frame(1), kSpec, Bytes(7), kStart);
  EXPECT_FALSE(refused.Take(Frame(1), std::make_shared<const JobSpec>()));
  EXPECT_EQ(refused.bytes(), 0u);
  EXPECT_FALSE(refused.Take(Frame(1), kSpec));
}

TEST(RefusedPictures, KeepsNoMoreThanItsLimitOrASinglePicture) {
  RefusedPictures refused(100);
  refused.Keep(Frame(1), kSpec, Bytes(150), kStart);
  refused.Keep(Frame(2), kSpec, Bytes(10), kStart);
  EXPECT_EQ(refused.bytes(), 150u);
  EXPECT_TRUE(refused.Take(Frame(1), kSpec));
  refused.Keep(Frame(1), kSpec, Bytes(60), kStart);
  refused.Keep(Frame(2), kSpec, Bytes(40), kStart);
  refused.Keep(Frame(3), kSpec, Bytes(1), kStart);
  EXPECT_EQ(refused.bytes(), 100u);
  EXPECT_FALSE(refused.Take(Frame(3), kSpec));
  EXPECT_TRUE(refused.Take(Frame(2), kSpec));
}

TEST(RefusedPictures, ReplacesThePictureOfTheSameFrame) {
  RefusedPictures refused(100);
  refused.Keep(Frame(1), kSpec, Bytes(60), kStart);
  refused.Keep(Frame(1), kSpec, Bytes(70), kStart);
  EXPECT_EQ(refused.bytes(), 70u);
}

TEST(RefusedPictures, MakesRoomForOthersOnceNobodyAsksForAPictureAnyMore) {
  RefusedPictures refused(100);
  refused.Keep(Frame(1), kSpec, Bytes(100), kStart);
  refused.Keep(Frame(2), kSpec, Bytes(10), kStart + minutes(4));
  EXPECT_EQ(refused.bytes(), 100u);
  refused.Keep(Frame(2), kSpec, Bytes(10), kStart + minutes(6));
  EXPECT_EQ(refused.bytes(), 10u);
}

TEST(RefusedPictures, ForgetsTheFramesOfAJob) {
  RefusedPictures refused(100);
  refused.Keep(Frame(1), kSpec, Bytes(10), kStart);
  refused.Keep(Frame(1, 1), kSpec, Bytes(10), kStart);
  refused.Keep(Frame(2), kSpec, Bytes(10), kStart);
  refused.Remove(JobId{1});
  EXPECT_EQ(refused.bytes(), 10u);
  EXPECT_TRUE(refused.Take(Frame(2), kSpec));
}

}  // namespace
}  // namespace tessera
