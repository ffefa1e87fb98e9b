// What workers are given: sizes, numbers, order.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;

TEST(SchedulerSizing, EverySlotHoldsAUnitMoreThanItRenders) {
  SchedulerStage stage;
  stage.AddJob(256);
  stage.Join(1, 3);
  stage.Advance();
  EXPECT_EQ(stage.Held(1).size(), 3u * kUnitsPerSlotMin);
}

TEST(SchedulerSizing, SlotsAreFilledBeforeAnyUnitWaits) {
  SchedulerStage stage;
  stage.AddJob(1);  // 16 units
  stage.Join(1, 8);
  stage.Join(2, 8);
  stage.Advance();
  EXPECT_EQ(stage.Held(1).size(), 8u);
  EXPECT_EQ(stage.Held(2).size(), 8u);
}

TEST(SchedulerSizing, MoreShortUnitsWaitUpToALimit) {
  SchedulerStage stage;
  stage.AddJob(1024);
  stage.Join(1);
  stage.Advance();
  stage.FinishAll(1, 0.004);  // first pass units of 2 samples = 8 ms
  stage.Advance();
  const double seconds = 0.008 * static_cast<double>(stage.Held(1).size());
  EXPECT_GT(seconds, kPrefetchDuration_s * 0.9);
  EXPECT_LT(seconds, kPrefetchDuration_s * 1.3);
  stage.FinishAll(1, 1e-9);
  stage.FinishAll(1, 1e-9);
  stage.Advance();
  EXPECT_LE(stage.Held(1).size(), static_cast<size_t>(kUnitsPerSlotMax));
}

// Renders the job with one worker per entry of `speeds`, in simulated time; the duration of each unit in
// order of its end.
std::vector<double> RenderWith(const std::vector<double>& speeds, uint32_t samples, double cost,
                               double* end_s = nullptr) {
  SchedulerStage stage;
  stage.AddJob(samples);
  for (size_t w = 0; w < speeds.size(); ++w) stage.Join(w + 1);
  const Instant begin = stage.now;
  std::map<uint64_t, std::pair<Instant, Lease>> running;
  std::vector<double> durations;
  while (true) {
    stage.Advance();
    for (size_t w = 0; w < speeds.size(); ++w) {
      if (running.contains(w + 1) || stage.Held(w + 1).empty()) continue;
      const Lease lease = stage.Held(w + 1).front();
      running[w + 1] = {stage.now + FromSeconds(cost * lease.unit.range.size / speeds[w]), lease};
    }
    if (running.empty()) break;
    const auto next = std::min_element(running.begin(), running.end(), [](const auto& a, const auto& b) {
      return a.second.first < b.second.first;
    });
    const auto [worker, job] = *next;
    running.erase(next);
    stage.now = std::max(stage.now, job.first);
    if (!stage.held[worker].contains(job.second.id)) continue;  // dropped meanwhile
    const double seconds = cost * job.second.unit.range.size / speeds[worker - 1];
    stage.Finish(worker, job.second, seconds);
    durations.push_back(seconds);
    for (size_t w = 0; w < speeds.size(); ++w) stage.Send(w + 1);
  }
  if (end_s != nullptr) *end_s = Seconds(stage.now - begin);
  EXPECT_TRUE(stage.IsComplete(JobId{1}, 0));
  return durations;
}

TEST(SchedulerSizing, UnitsAreLongInTheMiddleAndShrinkTowardsTheEnd) {
  const auto durations = RenderWith({1, 1}, 4096, 0.001);  // 65 s of work
  const double longest = *std::max_element(durations.begin(), durations.end());
  EXPECT_GT(longest, kUnitDurationMax_s / 2.1);
  EXPECT_LE(longest, kUnitDurationMax_s);
  for (size_t i = durations.size() - 4; i < durations.size(); ++i) EXPECT_LE(durations[i], 0.05) << i;
}

TEST(SchedulerSizing, NoUnitIsSoShortThatOverheadShows) {
  const auto durations = RenderWith({1, 1}, 4096, 0.001);
  const auto shorter = [](double duration) { return duration < kUnitDurationMin_s / 2; };
  // Only what alignment forces after the very first samples, and the first samples themselves.
  EXPECT_LE(std::count_if(durations.begin(), durations.end(), shorter), 16);
}

TEST(SchedulerSizing, SlotsOfDifferentSpeedFinishTogether) {
  double end_s = 0;
  RenderWith({1, 0.5, 0.25, 1}, 1024, 0.001, &end_s);
  const double bound = 16 * 1024 * 0.001 / 2.75;
  EXPECT_LT(end_s, bound * 1.05);
}

TEST(SchedulerSizing, ATenTimesSlowerWorkerDoesNotHoldUpTheFrame) {
  double end_s = 0;
  RenderWith({1, 1, 1, 0.1}, 512, 0.001, &end_s);
  const double bound = 16 * 512 * 0.001 / 3.1;
  EXPECT_LT(end_s, bound * 1.10);
}

TEST(SchedulerSizing, MoreSlotsThanTheCoordinatorCanServeGetLongerUnits) {
  constexpr int kSlots = 3000;
  SchedulerStage stage;
  stage.AddJob(1 << 20);
  for (uint64_t w = 1; w <= 3; ++w) stage.Join(w, kSlots / 3);
  double longest_s = 0;
  for (int round = 0; round < 12; ++round) {
    stage.Advance();
    for (uint64_t w = 1; w <= 3; ++w) {
      for (const Lease& lease : stage.Held(w)) longest_s = std::max(longest_s, 0.1 * lease.unit.range.size);
      stage.FinishAll(w, 0.1);
    }
  }
  EXPECT_GT(longest_s, kSlots / kResultsPerSecondMax / 2.1);
  EXPECT_LE(longest_s, kSlots / kResultsPerSecondMax * 1.1);
}

TEST(SchedulerSizing, TheNextFrameBeginsWhenNothingIsOpen) {
  SchedulerStage stage;
  stage.AddJob(1, 0, 2);
  stage.Join(1, 10);
  stage.Advance();
  size_t of_second = 0;
  for (const Lease& lease : stage.Held(1)) of_second += lease.unit.frame;
  EXPECT_EQ(stage.Held(1).size(), 20u);
  EXPECT_EQ(of_second, 4u) << "16 units of the first frame, then 4 of the second";
}

}  // namespace
}  // namespace tessera
