#include "coordinator/core/schedule/lease_table.h"

#include <gtest/gtest.h>

#include <set>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

constexpr WorkerId kAnn{1}, kBob{2};
constexpr JobId kJob{7};

struct TableStage {
  LeaseId Add(WorkerId worker, uint32_t tile, SampleRange range, std::optional<double> cost = 2.0,
              double speed = 1) {
    const LeaseId id = table.NextId();
    Lease lease;
    lease.id = id;
    lease.unit = {kJob, 0, tile, range};
    table.Add(now, {worker, 1, speed}, lease, cost);
    return id;
  }
  Instant now = seconds(100);
  LeaseTable table{77, 3};
};

TEST(LeaseTable, FindsLeasesByWorkerTileAndJob) {
  TableStage stage;
  const LeaseId first = stage.Add(kAnn, 5, {0, 4});
  const LeaseId second = stage.Add(kAnn, 2, {4, 4});
  const LeaseId third = stage.Add(kBob, 5, {4, 4});
  EXPECT_EQ(stage.table.OfWorker(kAnn), (std::vector{first, second}));
  EXPECT_EQ(stage.table.OfTile({kJob, 0, 5, {}}).size(), 2u);
  EXPECT_EQ(stage.table.OfJob(kJob), (std::vector{second, first, third})) << "by tile, then age";
  EXPECT_EQ(stage.table.ShareOf(kJob).holders,
            (std::unordered_map<WorkerId, uint32_t>{{kAnn, 2}, {kBob, 1}}));
  EXPECT_DOUBLE_EQ(stage.table.ShareOf(kJob).seconds, 6);
  stage.table.Remove(first);
  EXPECT_FALSE(stage.table.Has(first));
  EXPECT_EQ(stage.table.OfWorker(kAnn), std::vector{second});
  stage.table.Remove(second);
  stage.table.Remove(third);
  EXPECT_TRUE(stage.table.empty());
  EXPECT_EQ(stage.table.ShareOf(kJob).leases, 0u);
  EXPECT_TRUE(stage.table.OfTile({kJob, 0, 5, {}}).empty());
}

TEST(LeaseTable, ListsLeasesByIdThoughAnOlderOneWasTakenOver) {
  TableStage stage;
  const LeaseId second = stage.table.NextId(), third = stage.table.NextId();
  const LeaseId former{uint64_t{2} << 32 | 99};
  for (const LeaseId id : {third, former, second}) {
    Lease lease;
    lease.id = id;
    lease.unit = {kJob, 0, 5, {0, 4}};
    stage.table.Add(stage.now, {kAnn, 1, 1}, lease, 2.0);
  }
  const std::vector by_id{former, second, third};
  EXPECT_EQ(stage.table.OfWorker(kAnn), by_id);
  EXPECT_EQ(stage.table.OfJob(kJob), by_id);
  EXPECT_EQ(stage.table.Expired(stage.now + seconds(60)), by_id);
}

TEST(LeaseTable, LeasesOfOtherFramesStayWhenAFrameIsForgotten) {
  TableStage stage;
  const LeaseId ended = stage.Add(kAnn, 5, {0, 4});
  Lease other;
  other.id = stage.table.NextId();
  other.unit = {kJob, 1, 5, {0, 4}};
  stage.table.Add(stage.now, {kBob, 1, 1}, other, 2.0);
  EXPECT_EQ(stage.table.Remove(ended).worker, kAnn);
  stage.table.ForgetFrame(kJob, 0);
  EXPECT_TRUE(stage.table.OfTile({kJob, 0, 5, {}}).empty());
  EXPECT_EQ(stage.table.OfTile(other.unit).size(), 1u);
  EXPECT_EQ(stage.table.OfJob(kJob), std::vector{other.id});
  EXPECT_EQ(stage.table.ShareOf(kJob).leases, 1u);
}

TEST(LeaseTable, ExpectsALeaseToStartWhenThoseBeforeItEnd) {
  TableStage stage;
  const LeaseId first = stage.Add(kAnn, 0, {0, 4}, 2.0, 0.5);
  const LeaseId second = stage.Add(kAnn, 1, {0, 4}, 1.0, 0.5);
  EXPECT_EQ(stage.table.At(first).expected_end, stage.now + seconds(4));
  EXPECT_EQ(stage.table.At(second).expected_start, stage.now + seconds(4));
  EXPECT_DOUBLE_EQ(stage.table.QueueOf(kAnn).Seconds(0.5), 6);
  stage.table.At(second).is_announced = true;
  EXPECT_TRUE(stage.table.At(second).IsWaiting(stage.now));
  stage.table.Remove(first);
  stage.now += seconds(1);
  stage.table.StartNext(stage.now, kAnn);
  EXPECT_FALSE(stage.table.At(second).IsWaiting(stage.now));
  EXPECT_EQ(stage.table.At(second).expected_end, stage.now + seconds(2));
}

TEST(LeaseTable, ALeaseOfUnknownCostTakesTheDefaultDuration) {
  TableStage stage;
  const LeaseId id = stage.Add(kAnn, 0, {0, 1}, std::nullopt);
  EXPECT_DOUBLE_EQ(stage.table.QueueOf(kAnn).Seconds(1), kUnknownUnitDuration_s);
  stage.table.Remove(id);
  EXPECT_DOUBLE_EQ(stage.table.QueueOf(kAnn).Seconds(1), 0);
}

TEST(LeaseTable, ALeaseExpiresUnlessAStateListsIt) {
  TableStage stage;
  const LeaseId lost = stage.Add(kAnn, 0, {0, 1});
  const LeaseId listed = stage.Add(kAnn, 1, {0, 1});
  const Instant later = stage.now + kLeaseUnlistedMax + milliseconds(1);
  LeaseTable::Renew(later, stage.table.At(listed), {listed, {}, LeaseStage::kRunning, milliseconds(500)});
  EXPECT_EQ(stage.table.Expired(later), std::vector{lost});
  EXPECT_TRUE(stage.table.At(listed).has_started);
  EXPECT_EQ(stage.table.At(listed).expected_start, later - milliseconds(500));
  EXPECT_EQ(stage.table.Expired(later + kLeaseDuration + milliseconds(1)).size(), 2u);
}

TEST(LeaseTable, TheLastToEndIsTheOneThatIsLateLongest) {
  TableStage stage;
  const LeaseId shorter = stage.Add(kAnn, 0, {0, 1}, 1.0);
  const LeaseId longer = stage.Add(kBob, 1, {0, 1}, 3.0);
  EXPECT_EQ(stage.table.LastToEnd(stage.now, 2), (std::vector{longer, shorter}));
  // 9 s late: may be there in 9 s more. The other one is 7 s late.
  EXPECT_EQ(stage.table.LastToEnd(stage.now + seconds(10), 1), std::vector{shorter});
}

// Sessions are random, so they stay apart however directories are restored.
TEST(LeaseTable, IdsOfDifferentSessionsNeverMeetAndThoseOfLaterEpochsAreLarger) {
  LeaseTable one(77, 3), twin(78, 3), next(79, 4);
  std::set<LeaseId> ids;
  for (int i = 0; i < 100; ++i) {
    for (LeaseTable* const table : {&one, &twin, &next}) EXPECT_TRUE(ids.insert(table->NextId()).second);
  }
  const LeaseId first = LeaseTable(80, 3).NextId();
  constexpr uint64_t kMonthsOfLeases = uint64_t{1} << 33;  // 100 days at 1,000 a second
  EXPECT_LT(first.number + kMonthsOfLeases, LeaseTable(80, 4).NextId().number);
}

TEST(LeaseTable, KnowsWhichIdsMayHaveBeenGiven) {
  TableStage stage;
  const LeaseId given = stage.Add(kAnn, 0, {0, 1});
  EXPECT_TRUE(stage.table.MayHaveGiven(given));
  EXPECT_FALSE(stage.table.MayHaveGiven({given.number + 1, given.session}));
  EXPECT_TRUE(stage.table.MayHaveGiven({given.number + 1, given.session + 1})) << "by a former process";
}

TEST(LeaseTable, RemembersWhoseLeasesEnded) {
  TableStage stage;
  const LeaseId id = stage.Add(kAnn, 0, {0, 1});
  const WorkUnit unit = stage.table.At(id).lease.unit;
  for (const bool has_ended : {false, true}) {
    if (has_ended) stage.table.Remove(id);
    EXPECT_TRUE(stage.table.MayHaveBeen(id, kAnn, unit));
    EXPECT_FALSE(stage.table.MayHaveBeen(id, kBob, unit));
    WorkUnit other = unit;
    ++other.tile;
    EXPECT_FALSE(stage.table.MayHaveBeen(id, kAnn, other));
    EXPECT_FALSE(stage.table.MayHaveBeen({id.number + 1, id.session}, kAnn, unit)) << "never given";
  }
  EXPECT_TRUE(stage.table.MayHaveBeen({uint64_t{1} << 40 | 5, id.session + 1}, kAnn, unit))
      << "of a former process, which took what it knew with it";
  EXPECT_FALSE(stage.table.MayHaveBeen({id.number, id.session + 1}, kAnn, unit))
      << "there was no such process";
  EXPECT_FALSE(stage.table.MayHaveBeen({5, id.session + 1}, kAnn, unit)) << "nor such a one";
}

}  // namespace
}  // namespace tessera
