#include "coordinator/core/schedule/worker_roster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::ElementsAre;

struct RosterStage {
  // A new process of a member.
  WorkerRecord& JoinOf(uint64_t id, MemberId member, uint64_t machine) {
    WorkerState state;
    state.worker = WorkerId{id};
    state.name = "w" + std::to_string(id);
    state.member = member;
    state.machine = machine;
    WorkerRecord& worker = *roster.Admit(now, state).first;
    roster.TakeOverStrikes(worker);
    return worker;
  }
  void Leave(uint64_t id) { roster.Disconnect(now, roster.At(WorkerId{id})); }
  WorkerRecord& Join(uint64_t id, std::set<std::string> tags = {}, int slots = 1) {
    WorkerState state;
    state.worker = WorkerId{id};
    state.name = "w" + std::to_string(id);
    state.tags = std::move(tags);
    state.slots = slots;
    WorkerRecord& worker = *roster.Admit(now, state).first;
    roster.UpdateTotals(worker);
    return worker;
  }
  Instant now = seconds(100);
  WorkerRoster roster;
};

TEST(WorkerRoster, CountsSlotsAndSpeedOfWorkersThatMayWork) {
  RosterStage stage;
  stage.Join(1, {}, 4);
  WorkerRecord& second = stage.Join(2, {}, 2);
  EXPECT_EQ(stage.roster.total_slots(), 6);
  stage.roster.MeasureSpeed(second, 10, 5, true);  // twice as fast; the first measurement counts in full
  EXPECT_DOUBLE_EQ(second.speed, 2);
  EXPECT_DOUBLE_EQ(stage.roster.total_speed(), 8);
  EXPECT_TRUE(stage.roster.Drain(second));
  EXPECT_EQ(stage.roster.total_slots(), 4);
  EXPECT_TRUE(stage.roster.Release(second));
  EXPECT_DOUBLE_EQ(stage.roster.total_speed(), 8);
}

TEST(WorkerRoster, ShortUnitsAndUnmeasuredTilesChangeTheSpeedLess) {
  RosterStage stage;
  WorkerRecord& worker = stage.Join(1);
  stage.roster.MeasureSpeed(worker, 4 * kSpeedUnitDuration_s / 10, kSpeedUnitDuration_s / 10, true);
  EXPECT_GT(worker.speed, 1.0);
  EXPECT_LT(worker.speed, 1.2) << "a tenth of the shortest duration that counts in full";
  WorkerRecord& other = stage.Join(2);
  stage.roster.MeasureSpeed(other, 4, 1, false);
  EXPECT_NEAR(other.speed, std::sqrt(2.0), 1e-9) << "a quarter of the gain: 4^(1/4)";
}

TEST(WorkerRoster, ReportsBlocksOnceAndRestoresThem) {
  RosterStage stage;
  WorkerRecord& worker = stage.Join(1);
  EXPECT_TRUE(stage.roster.Quarantine(worker, "wrong sums"));
  EXPECT_FALSE(stage.roster.Quarantine(worker, "again"));
  const auto blocks = stage.roster.TakeBlocks();
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].quarantine, "wrong sums");
  EXPECT_TRUE(stage.roster.TakeBlocks().empty());
  RosterStage after;
  after.roster.RestoreBlock(after.now, blocks[0]);
  EXPECT_FALSE(after.Join(1).may_work());
  EXPECT_TRUE(after.roster.HasNews(WorkerId{1})) << "it is told why";
}

TEST(WorkerRoster, StrikesInARowLeadToQuarantineAndManyGoodUnitsForgiveThem) {
  RosterStage stage;
  WorkerRecord& worker = stage.Join(1);
  for (int i = 1; i < kStrikesMax; ++i) EXPECT_FALSE(stage.roster.AddStrike(worker));
  for (int i = 0; i < kForgivenessUnits; ++i) WorkerRoster::CreditUnit(worker);
  EXPECT_EQ(worker.strikes, 0);
  for (int i = 1; i < kStrikesMax; ++i) EXPECT_FALSE(stage.roster.AddStrike(worker));
  EXPECT_TRUE(stage.roster.AddStrike(worker));
}

constexpr MemberId kAda{7}, kBob{8};

TEST(WorkerRoster, ARestartDoesNotForgiveStrikes) {
  RosterStage stage;
  for (uint64_t id = 1; id < kStrikesMax; ++id) {
    EXPECT_FALSE(stage.roster.AddStrike(stage.JoinOf(id, kAda, 5)));
    stage.Leave(id);
  }
  EXPECT_TRUE(stage.roster.AddStrike(stage.JoinOf(9, kAda, 5))) << "the third of the machine";
}

TEST(WorkerRoster, AStrikeOfAProcessThatHasGoneMeetsTheNextOne) {
  RosterStage stage;
  WorkerRecord& gone = stage.JoinOf(1, kAda, 5);
  ++gone.units_failed;
  stage.Leave(1);
  EXPECT_EQ(stage.JoinOf(2, kAda, 5).strikes, 0);
  EXPECT_THAT(stage.roster.ForgetGone(stage.now + kFailedWorkerForgotten), testing::IsEmpty());
  stage.roster.AddStrike(gone);
  EXPECT_EQ(stage.JoinOf(3, kAda, 5).strikes, 1);
  EXPECT_EQ(stage.JoinOf(4, kAda, 5).strikes, 0) << "it counts once";
}

TEST(WorkerRoster, OtherMachinesAndMembersDoNotTakeStrikesOver) {
  RosterStage stage;
  stage.JoinOf(1, kAda, 6);
  stage.roster.AddStrike(stage.JoinOf(2, kAda, 5));
  stage.Leave(2);
  EXPECT_EQ(stage.JoinOf(3, kAda, 6).strikes, 0);
  EXPECT_EQ(stage.JoinOf(4, kBob, 5).strikes, 0);
  EXPECT_EQ(stage.JoinOf(5, MemberId{}, 5).strikes, 0);
  EXPECT_EQ(stage.JoinOf(6, kAda, 5).strikes, 1);
}

TEST(WorkerRoster, AMachineThatNobodyKnowsMayBeAnyOfItsMember) {
  RosterStage stage;
  stage.roster.AddStrike(stage.JoinOf(1, kAda, 5));
  stage.Leave(1);
  EXPECT_EQ(stage.JoinOf(2, kAda, 77).strikes, 1);
  stage.Leave(2);
  EXPECT_EQ(stage.JoinOf(3, kAda, 0).strikes, 1);
}

TEST(WorkerRoster, WhoStandsInForAProcessInQuarantineIsQuarantinedAfterItsFirstFailure) {
  RosterStage stage;
  stage.roster.Quarantine(stage.JoinOf(1, kAda, 5), "wrong sums");
  stage.Leave(1);
  WorkerRecord& next = stage.JoinOf(2, kAda, 77);
  EXPECT_TRUE(next.may_work());
  EXPECT_TRUE(stage.roster.AddStrike(next));
  stage.roster.Release(stage.roster.At(WorkerId{1}));
  EXPECT_EQ(stage.JoinOf(3, kAda, 78).strikes, 0) << "an operator has looked at it";
}

TEST(WorkerRoster, ExplainsWhyNoWorkerIsAble) {
  RosterStage stage;
  EXPECT_EQ(stage.roster.WhyNoneFor({}), "no worker is connected");
  WorkerRecord& worker = stage.Join(1, {"gpu"});
  EXPECT_EQ(stage.roster.WhyNoneFor({"big"}), "no worker has tag big");
  stage.Join(2, {"big"});
  EXPECT_EQ(stage.roster.WhyNoneFor({"big", "gpu"}), "no worker has all of the tags big, gpu");
  stage.roster.Drain(worker);
  EXPECT_EQ(stage.roster.WhyNoneFor({"gpu"}), "no worker with tag gpu accepts work: 1 drained");
  stage.roster.Disconnect(stage.now, worker);
  EXPECT_EQ(stage.roster.WhyNoneFor({"gpu"}), "no connected worker has tag gpu; 1 that had is gone");
  EXPECT_THAT(stage.roster.AbleFor({"big"}), ElementsAre(WorkerId{2}));
}

TEST(WorkerRoster, ForgetsWorkersThatAreAwayButBlockedOnesLater) {
  RosterStage stage;
  stage.Join(1);
  WorkerRecord& drained = stage.Join(2);
  stage.roster.Drain(drained);
  EXPECT_THAT(stage.roster.Silent(stage.now + kWorkerSilenceMax + milliseconds(1)),
              ElementsAre(WorkerId{1}, WorkerId{2}));
  for (auto& [id, worker] : stage.roster.all()) stage.roster.Disconnect(stage.now, worker);
  const Instant later = stage.now + kWorkerForgotten + milliseconds(1);
  EXPECT_THAT(stage.roster.ForgetGone(later), ElementsAre(WorkerId{1}));
  EXPECT_NE(stage.roster.Find(WorkerId{2}), nullptr);
}

TEST(WorkerRoster, WorkersThatHaveGoneGiveTheirPlacesUpBlockedOnesDoNot) {
  RosterStage stage;
  for (uint64_t id = 1; id <= kWorkersMax; ++id) stage.Join(id);
  EXPECT_TRUE(stage.roster.is_full());
  EXPECT_EQ(stage.roster.MakePlace(), std::nullopt);
  stage.roster.Drain(stage.roster.At(WorkerId{1}));
  stage.roster.Disconnect(stage.now, stage.roster.At(WorkerId{1}));
  EXPECT_TRUE(stage.roster.is_full()) << "a drained worker is remembered";
  stage.now += seconds(1);
  stage.roster.Disconnect(stage.now, stage.Join(3));
  stage.now += seconds(1);
  stage.roster.Disconnect(stage.now, stage.Join(2));
  EXPECT_FALSE(stage.roster.is_full());
  EXPECT_EQ(stage.roster.MakePlace(), WorkerId{3}) << "it has been away for longest";
  EXPECT_EQ(stage.roster.MakePlace(), std::nullopt) << "there is a place";
  stage.Join(kWorkersMax + 1);
  stage.Join(2);
  EXPECT_TRUE(stage.roster.is_full()) << "one that has come back keeps its place";
}

TEST(WorkerRoster, RevokedLeasesAreRememberedUpToALimit) {
  RosterStage stage;
  WorkerRecord& worker = stage.Join(1);
  for (uint64_t i = 1; i <= kRevokedKeptMax + 1; ++i) stage.roster.Revoke(worker, LeaseId{i});
  EXPECT_EQ(worker.revoked.size(), kRevokedKeptMax);
  EXPECT_FALSE(worker.revoked.contains(LeaseId{1}));
  EXPECT_EQ(worker.pending.drops.size(), kRevokedKeptMax + 1);
}

}  // namespace
}  // namespace tessera
