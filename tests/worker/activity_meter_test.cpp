#include "worker/activity_meter.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using std::chrono::milliseconds;

TEST(ActivityMeter, MeasuresWhatSlotsDoAndWhyTheOthersWait) {
  ActivityMeter::TimePoint now;
  ActivityMeter meter(4, now);
  now += milliseconds(10);  // 4 idle
  meter.LoaderDoes(ActivityMeter::Loader::kFetching, now);
  now += milliseconds(20);  // 4 wait for files
  meter.LoaderDoes(ActivityMeter::Loader::kLoading, now);
  meter.SlotBegins(now);
  now += milliseconds(30);  // 1 renders, 3 wait for the scene
  meter.LoaderDoes(ActivityMeter::Loader::kIdle, now);
  now += milliseconds(40);  // 1 renders, 3 idle
  meter.SlotEnds(now);
  meter.Fetched(7);
  WorkerState state;
  meter.Fill(state, now);
  EXPECT_EQ(state.activity.idle_ms, 40u + 120u);
  EXPECT_EQ(state.activity.fetching_ms, 80u);
  EXPECT_EQ(state.activity.loading_ms, 90u);
  EXPECT_EQ(state.activity.busy_ms, 70u);
  EXPECT_EQ(state.activity.bytes_fetched, 7u);
}

TEST(ActivityMeter, MarksScenesWhoseFilesAreBeingFetched) {
  const ActivityMeter::TimePoint now;
  ActivityMeter meter(1, now);
  WorkerState state;
  state.scenes = {{Sha256("ready"), true}, {Sha256("coming"), false}};
  meter.Fill(state, now);
  EXPECT_FALSE(state.scenes[1].fetching);
  meter.LoaderDoes(ActivityMeter::Loader::kFetching, now);
  meter.Fill(state, now);
  EXPECT_FALSE(state.scenes[0].fetching);
  EXPECT_TRUE(state.scenes[1].fetching);
}

}  // namespace
}  // namespace tessera
