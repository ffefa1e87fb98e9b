// What workers are told to fetch ahead.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::seconds;

TEST(SchedulerPrefetch, AWorkerFetchesTheNextScenesWhileItRenders) {
  SchedulerStage stage;
  const JobId first = stage.AddJob(1024);
  stage.Worker(1, 2);
  stage.HaveScene(1, first);
  stage.Send(1);
  stage.Advance();
  EXPECT_TRUE(stage.told[1].prefetch.empty()) << "there is nothing else";
  const JobId later = stage.AddJob(1024, -1);
  const JobId next = stage.AddJob(1024, 0);
  stage.Advance(seconds(2));
  const std::vector<Digest> expected{stage.specs.at(next)->package, stage.specs.at(later)->package};
  EXPECT_EQ(stage.told[1].prefetch, expected) << "in the order of priority";
  stage.told[1].prefetch.clear();
  stage.Advance(seconds(2));
  EXPECT_TRUE(stage.told[1].prefetch.empty()) << "said once";
}

}  // namespace
}  // namespace tessera
