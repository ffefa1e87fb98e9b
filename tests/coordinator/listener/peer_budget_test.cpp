#include "coordinator/listener/peer_budget.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using std::chrono::seconds;

constexpr PeerBudget::TimePoint kStart{std::chrono::hours(1)};

PeerNetwork Peer(uint8_t number) {
  PeerNetwork network;
  network.bytes[15] = number;
  return network;
}

TEST(PeerBudget, AttemptsRunOutAndComeBackWithTime) {
  PeerBudget budget({2, 0.5});
  EXPECT_TRUE(budget.Take(Peer(1), kStart));
  EXPECT_TRUE(budget.Take(Peer(1), kStart));
  EXPECT_FALSE(budget.Take(Peer(1), kStart + seconds(1)));
  EXPECT_TRUE(budget.Take(Peer(1), kStart + seconds(2)));
  EXPECT_FALSE(budget.Take(Peer(1), kStart + seconds(2)));
}

TEST(PeerBudget, PeersDoNotAffectEachOther) {
  PeerBudget budget({1, 0.1});
  EXPECT_TRUE(budget.Take(Peer(1), kStart));
  EXPECT_FALSE(budget.Take(Peer(1), kStart));
  EXPECT_TRUE(budget.Take(Peer(2), kStart));
}

TEST(PeerBudget, GoodAttemptsAreReturned) {
  PeerBudget budget({1, 0.1});
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(budget.Take(Peer(1), kStart));
    budget.GiveBack(Peer(1));
  }
}

TEST(PeerBudget, ACrowdOfPeersSharesOneBudgetAndIsForgottenAgain) {
  PeerBudget budget({1, 1, 2});
  EXPECT_TRUE(budget.Take(Peer(1), kStart));
  EXPECT_TRUE(budget.Take(Peer(2), kStart));
  EXPECT_TRUE(budget.Take(Peer(3), kStart));
  EXPECT_FALSE(budget.Take(Peer(4), kStart));
  EXPECT_EQ(budget.size(), 3u);
  EXPECT_TRUE(budget.Take(Peer(4), kStart + seconds(10)));
  EXPECT_EQ(budget.size(), 1u);
}

}  // namespace
}  // namespace tessera
