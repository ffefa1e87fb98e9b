// What happens to leases when workers are silent, late, lost, or send something unexpected.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/former_lease.h"
#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A farm with one job of 16 units of one sample, all held by worker 1, none by worker 2.
struct OneHoldsAll : SchedulerStage {
  OneHoldsAll() {
    job = AddJob(1);
    Join(1, 16);
    Advance();
    EXPECT_EQ(Held(1).size(), 16u);
    Join(2, 16);
    Advance();
    EXPECT_EQ(Held(2).size(), 0u);
  }
  JobId job{};
};

TEST(SchedulerLeases, LeasesReturnImmediatelyWhenTheConnectionBreaks) {
  OneHoldsAll stage;
  stage.scheduler.Disconnect(stage.now, WorkerId{1});
  stage.Advance();
  EXPECT_EQ(stage.Held(2).size(), 16u);
  EXPECT_EQ(stage.Status(1), "unknown");
}

TEST(SchedulerLeases, LeasesReturnWhenTheWorkerLeaves) {
  OneHoldsAll stage;
  stage.Worker(1).leaving = true;
  stage.Send(1);
  stage.Advance();
  EXPECT_EQ(stage.Held(2).size(), 16u);
}

TEST(SchedulerLeases, LeasesReturnWhenTheWorkerIsSilent) {
  OneHoldsAll stage;
  for (int second = 0; second < 4; ++second) {
    stage.Send(1);
    stage.Send(2);
    stage.Advance(seconds(1));
  }
  const auto begin = stage.now;
  while (stage.Status(1) != "unknown") {
    stage.Send(2);
    stage.Advance(milliseconds(500));
    ASSERT_LE(stage.now - begin, kWorkerSilenceMax + seconds(1));
  }
  EXPECT_GE(stage.now - begin, kWorkerSilenceMax - seconds(1));
  EXPECT_EQ(stage.Held(2).size(), 16u);
}

TEST(SchedulerLeases, LateResultAfterExpiryIsAccepted) {
  OneHoldsAll stage;
  const Lease late = stage.Held(1)[3];
  stage.scheduler.Disconnect(stage.now, WorkerId{1});
  stage.Advance();
  EXPECT_TRUE(stage.Finish(1, late, 0.1));
  stage.Advance();
  EXPECT_EQ(stage.Held(2).size(), 15u) << "the new holder is told to stop";
  EXPECT_EQ(stage.dropped[2].size(), 1u);
}

TEST(SchedulerLeases, AResultOfAnUnknownWorkerIsAccepted) {
  OneHoldsAll stage;
  EXPECT_TRUE(stage.Finish(99, stage.Held(1)[0], 0.1));
}

TEST(SchedulerLeases, DuplicateIsCountedOnce) {
  OneHoldsAll stage;
  const Lease lease = stage.Held(1)[0];
  EXPECT_TRUE(stage.Finish(1, lease, 0.1));
  EXPECT_FALSE(stage.Finish(1, lease, 0.1));
  EXPECT_FALSE(stage.Finish(2, lease, 0.1));
  EXPECT_EQ(stage.scheduler.Workers(stage.now)[0].units_finished, 1u);
}

TEST(SchedulerLeases, ALostAnswerIsSentAgain) {
  SchedulerStage stage;
  stage.AddJob(64);
  stage.Join(1);
  stage.Advance();
  const auto lost = stage.Held(1);
  stage.held[1].clear();
  stage.Advance(milliseconds(500));
  stage.Send(1);
  stage.Advance();
  ASSERT_EQ(stage.Held(1).size(), lost.size());
  EXPECT_EQ(stage.Held(1)[0].id, lost[0].id) << "the same leases, so that no copy is rendered twice";
}

TEST(SchedulerLeases, ALeaseThatIsNeverListedReturns) {
  OneHoldsAll stage;
  stage.held[1].clear();
  for (int i = 0; i < 9; ++i) {
    stage.now += seconds(1);
    stage.Send(1);
    stage.Send(2);
    stage.held[1].clear();  // it never gets what it is sent
    stage.scheduler.Advance(stage.now);
    stage.Deliver(2);
  }
  EXPECT_EQ(stage.Held(2).size(), 16u);
}

TEST(SchedulerLeases, ALeaseThatIsListedNeverExpires) {
  SchedulerStage stage;
  stage.AddJob(1);
  stage.Join(1, 16);
  stage.Advance();
  for (int i = 0; i < 100; ++i) {
    stage.Send(1);
    stage.Advance(seconds(5));
  }
  EXPECT_EQ(stage.Held(1).size(), 16u);
  EXPECT_TRUE(stage.dropped[1].empty());
}

TEST(SchedulerLeases, ADrainingWorkerKeepsWhatItListsAndGetsNothingNew) {
  SchedulerStage stage;
  stage.AddJob(64);
  stage.Join(1, 2);
  stage.Advance();
  ASSERT_EQ(stage.Held(1).size(), 4u);
  const Lease returned = stage.Held(1)[3];
  stage.held[1].erase(returned.id);
  stage.Worker(1).draining = true;
  stage.Worker(1).returned_leases = {returned.id};
  stage.Send(1);
  stage.Advance();
  EXPECT_EQ(stage.Held(1).size(), 3u);
  stage.FinishAll(1, 0.1);
  stage.Send(1);
  stage.Advance();
  EXPECT_TRUE(stage.Held(1).empty());
  stage.Join(2, 4);
  stage.Advance();
  const auto held = stage.Held(2);
  EXPECT_TRUE(
      std::any_of(held.begin(), held.end(), [&](const Lease& each) { return each.unit == returned.unit; }));
}

TEST(SchedulerLeases, AnOlderStateThatArrivesLateChangesNothing) {
  OneHoldsAll stage;
  WorkerState old = stage.states[1];
  old.leases.clear();
  old.leaving = true;
  stage.Send(1);
  old.sequence = stage.states[1].sequence - 1;
  stage.scheduler.Synchronize(stage.now, old);
  stage.Advance();
  EXPECT_EQ(stage.Status(1), "fine");
  EXPECT_EQ(stage.Held(1).size(), 16u);
}

TEST(SchedulerLeases, WorkOfAFormerCoordinatorIsTakenOver) {
  SchedulerStage before(SchedulerOptions{1});
  before.AddJob(64);
  before.Join(1, 2);
  before.Advance();
  SchedulerStage after(SchedulerOptions{2});
  after.AddJob(64);
  after.held[1] = before.held[1];
  after.Join(1, 2);
  after.Advance();
  EXPECT_EQ(after.held[1].size(), 4u) << "the worker goes on with what it has";
  EXPECT_TRUE(after.dropped[1].empty());
  const Lease lease = after.Held(1)[0];
  EXPECT_TRUE(after.Finish(1, lease, 0.1));
}

TEST(SchedulerLeases, AResultForAFormerCoordinatorThatIsOnItsWayIsNotLeasedAgain) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Worker(1);
  stage.HaveScene(1, job);
  WorkerState state = stage.states[1];
  const WorkUnit unit{job, 0, 0, {0, 16}, stage.SceneOf(job)};
  state.leases = {{FormerLease(5), unit, LeaseStage::kReturning, milliseconds(0)}};
  state.sequence = 1;
  stage.scheduler.Synchronize(stage.now, state);
  stage.Join(2, 32);
  stage.Advance();
  ASSERT_FALSE(stage.Held(2).empty());
  for (const Lease& lease : stage.Held(2))
    EXPECT_TRUE(lease.unit.tile != unit.tile || lease.unit.range.begin >= unit.range.end())
        << lease.unit.Text();
  EXPECT_TRUE(stage.scheduler.Finish(stage.now, WorkerId{1}, FormerLease(5), unit, 0.1));
}

TEST(SchedulerLeases, UnitsThatOthersHoldOrThatAreDoneAreNotTakenOver) {
  SchedulerStage before(SchedulerOptions{1});
  before.AddJob(1);
  before.Join(1, 16);
  before.Advance();
  SchedulerStage after(SchedulerOptions{2});
  after.AddJob(1);
  after.Join(2, 8);
  after.Advance();
  const Lease done = after.Held(2)[0];
  after.Finish(2, done, 0.1);
  after.held[1] = before.held[1];
  after.Join(1, 16);
  after.Advance();
  EXPECT_EQ(after.dropped[1].size(), 16u) << "all units are held by worker 2 or done";
}

TEST(SchedulerLeases, LeaseIdsOfTwoProcessesNeverMeet) {
  std::set<LeaseId> ids;
  for (uint32_t epoch = 1; epoch <= 3; ++epoch) {
    SchedulerStage stage(SchedulerOptions{epoch});
    stage.AddJob(1);
    stage.Join(1, 16);
    stage.Advance();
    for (const Lease& lease : stage.Held(1)) EXPECT_TRUE(ids.insert(lease.id).second);
  }
}

TEST(SchedulerLeases, AWorkerThatListsManyUnknownLeasesIsToldToDropThemPieceByPiece) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);
  stage.Join(1);
  for (int lie = 0; lie < 4; ++lie) {
    WorkerState& state = stage.Worker(1);
    state.leases.clear();
    ++state.sequence;
    for (uint64_t n = 0; n < uint64_t{kLeasesPerWorkerMax}; ++n)
      state.leases.push_back({LeaseId{n, 999}, {job, 5, 0, {0, 1}}, LeaseStage::kWaiting, {}});
    stage.scheduler.Synchronize(stage.now, state);
  }
  size_t drops = 0;
  while (stage.scheduler.HasNews(WorkerId{1})) {
    const WorkerDirective directive = stage.scheduler.TakeDirective(stage.now, WorkerId{1});
    EXPECT_LE(directive.drop.size(), kDropsPerAnswerMax);
    drops += directive.drop.size();
  }
  EXPECT_EQ(drops, size_t{kLeasesPerWorkerMax}) << "the rest follows if it lists them again";
}

}  // namespace
}  // namespace tessera
