#include "worker/core/held_leases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

const HeldLeases::TimePoint kStart{};

Digest SceneKey(uint8_t number) {
  Digest digest;
  digest.bytes[0] = number;
  return digest;
}

Lease MakeLease(uint64_t id, uint8_t scene = 1, milliseconds duration = milliseconds(9000)) {
  Lease lease;
  lease.id = LeaseId{id};
  lease.unit = {JobId{1}, 0, static_cast<uint32_t>(id), {0, 4}, SceneKey(scene)};
  lease.duration = duration;
  return lease;
}

bool AnyScene(const Digest&) {
  return true;
}

TEST(HeldLeases, UnitsStartInOrderOfArrivalOnceTheirScenesAreReady) {
  HeldLeases book;
  book.Add(MakeLease(1, 1), kStart);
  book.Add(MakeLease(2, 2), kStart);
  book.Add(MakeLease(3, 1), kStart);
  const auto only_second = [](const Digest& scene) { return scene == SceneKey(2); };
  EXPECT_EQ(book.Start(only_second, kStart)->lease.id, LeaseId{2});
  EXPECT_FALSE(book.Start(only_second, kStart));
  EXPECT_EQ(book.Start(AnyScene, kStart)->lease.id, LeaseId{1});
  EXPECT_EQ(book.Start(AnyScene, kStart)->lease.id, LeaseId{3});
  EXPECT_FALSE(book.Start(AnyScene, kStart));
  EXPECT_EQ(book.running(), 3u);
}

TEST(HeldLeases, ARepeatedLeaseIsHeldOnceAndNeverAgainAfterItWasForgotten) {
  HeldLeases book;
  EXPECT_TRUE(book.Add(MakeLease(1), kStart));
  EXPECT_FALSE(book.Add(MakeLease(1), kStart));
  book.Forget(LeaseId{1});
  EXPECT_FALSE(book.Add(MakeLease(1), kStart));
  EXPECT_TRUE(book.Held(kStart).empty());
}

TEST(HeldLeases, ADropThatOvertakesItsLeaseStillApplies) {
  HeldLeases book;
  book.Forget(LeaseId{1});
  EXPECT_FALSE(book.Add(MakeLease(1), kStart));
}

TEST(HeldLeases, ReportsTheStageOfEachLeaseAndItsDuration) {
  HeldLeases book;
  for (uint64_t id : {1, 2, 3}) book.Add(MakeLease(id), kStart);
  book.Start(AnyScene, kStart + milliseconds(10));
  book.Start(AnyScene, kStart + milliseconds(20));
  EXPECT_TRUE(book.Finish(LeaseId{1}, kStart + milliseconds(30)));
  const auto held = book.Held(kStart + milliseconds(100));
  ASSERT_EQ(held.size(), 3u);
  EXPECT_EQ(held[0].stage, LeaseStage::kReturning);
  EXPECT_EQ(held[0].stage_duration, milliseconds(70));
  EXPECT_EQ(held[1].stage, LeaseStage::kRunning);
  EXPECT_EQ(held[1].stage_duration, milliseconds(80));
  EXPECT_EQ(held[2].stage, LeaseStage::kWaiting);
  EXPECT_EQ(held[2].stage_duration, milliseconds(100));
}

TEST(HeldLeases, ForgettingARunningUnitStopsItAndItsResultIsNotWanted) {
  HeldLeases book;
  book.Add(MakeLease(1), kStart);
  const auto started = book.Start(AnyScene, kStart);
  EXPECT_FALSE(*started->stop);
  book.Forget(LeaseId{1});
  EXPECT_TRUE(*started->stop);
  EXPECT_FALSE(book.Finish(LeaseId{1}, kStart));
}

TEST(HeldLeases, TakesLeasesByStageAndByScene) {
  HeldLeases book;
  for (uint64_t id : {1, 2, 3, 4}) book.Add(MakeLease(id, id == 4 ? 2 : 1), kStart);
  const auto first = book.Start(AnyScene, kStart);
  book.Start(AnyScene, kStart);
  book.Finish(LeaseId{2}, kStart);
  EXPECT_TRUE(book.Uses(SceneKey(2)));
  EXPECT_THAT(book.TakeScene(SceneKey(2)), ElementsAre(LeaseId{4}));
  EXPECT_FALSE(book.Uses(SceneKey(2)));
  EXPECT_THAT(book.TakeWaiting(), ElementsAre(LeaseId{3}));
  EXPECT_THAT(book.TakeRunning(), ElementsAre(LeaseId{1}));
  EXPECT_TRUE(*first->stop);
  ASSERT_EQ(book.Held(kStart).size(), 1u);  // the result on its way stays
  EXPECT_EQ(book.Held(kStart)[0].id, LeaseId{2});
}

TEST(HeldLeases, KnowsTheShortestLease) {
  HeldLeases book;
  EXPECT_FALSE(book.ShortestDuration());
  book.Add(MakeLease(1, 1, milliseconds(900)), kStart);
  book.Add(MakeLease(2, 1, milliseconds(300)), kStart);
  EXPECT_EQ(book.ShortestDuration(), milliseconds(300));
}

}  // namespace
}  // namespace tessera
