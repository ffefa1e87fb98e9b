// Preparations that a worker has to do, does and has done.
#include "worker/core/preparation_queue.h"

#include <gtest/gtest.h>

#include "worker/core/workload.h"

namespace tessera {
namespace {

PreparationRequest Preparation(const std::string& name) {
  return {Sha256(name), {Sha256("package"), name + ".pbrt", "", std::nullopt, 24}};
}

PreparationReport FramesOfPreparation(const std::string& name) {
  PreparationReport report;
  report.key = Sha256(name);
  report.frames.emplace_back();
  return report;
}

TEST(PreparationQueue, DoesEachOnceAndReportsItUntilItIsAnswered) {
  PreparationQueue queue;
  queue.Add(Preparation("a"));
  queue.Add(Preparation("a"));
  queue.Add(Preparation("b"));
  EXPECT_EQ(queue.Start()->key, Sha256("a"));
  queue.Add(Preparation("a"));
  EXPECT_EQ(queue.Start()->key, Sha256("b"));
  EXPECT_FALSE(queue.Start());
  EXPECT_EQ(queue.NextReport(), nullptr);
  queue.Finish(FramesOfPreparation("a"));
  queue.Add(Preparation("a"));
  EXPECT_FALSE(queue.Start()) << "its report is on its way";
  EXPECT_EQ(queue.NextReport()->key, Sha256("a"));
  EXPECT_EQ(queue.Held().size(), 2u);
  queue.Answered(Sha256("a"));
  EXPECT_EQ(queue.NextReport(), nullptr);
  EXPECT_EQ(queue.Held(), std::vector<Digest>{Sha256("b")});
}

TEST(PreparationQueue, WhatIsRefusedIsReportedAsAFailure) {
  PreparationQueue queue;
  queue.Add(Preparation("a"));
  (void)queue.Start();
  queue.Finish(FramesOfPreparation("a"));
  queue.Refuse(Sha256("a"), "too large");
  EXPECT_TRUE(queue.NextReport()->frames.empty());
  EXPECT_EQ(queue.NextReport()->reason, "too large");
  queue.Refuse(Sha256("a"), "too large");
  EXPECT_EQ(queue.NextReport(), nullptr) << "there is nothing else to try";
}

TEST(PreparationQueue, HasABoundedNumber) {
  PreparationQueue queue;
  for (int i = 0; i < 2 * kPreparationsPerWorkerMax; ++i) queue.Add(Preparation(std::to_string(i)));
  EXPECT_EQ(queue.Held().size(), static_cast<size_t>(kPreparationsPerWorkerMax));
}

TEST(Workload, PreparationsOfAnotherFarmAreForgottenAndADrainTakesNoNew) {
  Workload load;
  WorkerDirective directive;
  directive.farm = {1, 1};
  directive.preparation = Preparation("a");
  load.Apply(directive, {});
  EXPECT_TRUE(load.StartPreparation());
  directive.farm = {2, 2};
  directive.preparation = Preparation("b");
  load.Apply(directive, {});
  load.PreparationFinished(FramesOfPreparation("a"));
  EXPECT_FALSE(load.HasBatch()) << "nobody of this farm asked for it";
  EXPECT_TRUE(load.StartPreparation());
  directive.preparation = Preparation("c");
  load.Apply(directive, {});
  load.Drain();
  EXPECT_FALSE(load.StartPreparation());
  EXPECT_TRUE(load.IsIdle()) << "what is being prepared does not delay the end";
  load.PreparationFinished(FramesOfPreparation("b"));
  EXPECT_FALSE(load.IsIdle());
  WorkerState state;
  load.FillState(state, {});
  EXPECT_EQ(state.preparations, std::vector<Digest>{Sha256("b")});
  const auto batch = load.NextBatch(1000);
  const auto* report = std::get_if<PreparationQueue::Report>(&batch);
  ASSERT_NE(report, nullptr);
  EXPECT_EQ((*report)->farm, (FarmId{2, 2}));
  load.PreparationAnswered(**report);
  EXPECT_TRUE(load.IsIdle());
}

}  // namespace
}  // namespace tessera
