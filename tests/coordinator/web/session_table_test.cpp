#include "coordinator/web/session_table.h"

#include <gtest/gtest.h>

#include <set>

namespace tessera {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

constexpr SessionTable::TimePoint kStart{std::chrono::hours(1000)};

TEST(SessionTable, ASessionIsFoundByItsSecretAlone) {
  SessionTable table;
  const std::string secret = table.Open(MemberId{7}, kStart);
  EXPECT_EQ(secret.size(), 64u);
  EXPECT_EQ(table.Use(secret, kStart), MemberId{7});
  EXPECT_FALSE(table.Use("", kStart));
  EXPECT_FALSE(table.Use(std::string(64, '0'), kStart));
  EXPECT_FALSE(table.Use(Sha256(secret).Hex(), kStart)) << "what is kept opens nothing";
  table.End(secret);
  EXPECT_FALSE(table.Use(secret, kStart));
}

TEST(SessionTable, ASessionEndsWhenItIsNotUsed) {
  SessionTable table;
  const std::string secret = table.Open(MemberId{7}, kStart);
  EXPECT_TRUE(table.Use(secret, kStart + kSessionIdleMax - seconds(1)));
  EXPECT_TRUE(table.Use(secret, kStart + 2 * kSessionIdleMax - seconds(2)));
  EXPECT_FALSE(table.Use(secret, kStart + 3 * kSessionIdleMax));
  EXPECT_EQ(table.size(), 0u);
}

TEST(SessionTable, ASessionEndsAfterItsLifetimeHoweverMuchItIsUsed) {
  SessionTable table;
  const std::string secret = table.Open(MemberId{7}, kStart);
  for (minutes age{30}; age < kSessionLifetime; age += minutes(30))
    EXPECT_TRUE(table.Use(secret, kStart + age)) << age.count();
  EXPECT_FALSE(table.Use(secret, kStart + kSessionLifetime));
}

TEST(SessionTable, SessionsAreBoundedAndTheOneUnusedForLongestGivesWay) {
  SessionTable table;
  const std::string first = table.Open(MemberId{1}, kStart), second = table.Open(MemberId{2}, kStart);
  std::set<std::string> secrets{first, second};
  for (size_t i = 2; i < kSessionsMax; ++i) secrets.insert(table.Open(MemberId{3}, kStart + seconds(1)));
  EXPECT_EQ(secrets.size(), kSessionsMax);
  EXPECT_TRUE(table.Use(first, kStart + seconds(2)));
  table.Open(MemberId{4}, kStart + seconds(2));
  EXPECT_EQ(table.size(), kSessionsMax);
  EXPECT_TRUE(table.Use(first, kStart + seconds(3)));
  EXPECT_FALSE(table.Use(second, kStart + seconds(3)));
}

TEST(SessionTable, LookingWhetherASessionIsOpenDoesNotKeepItOpen) {
  SessionTable sessions;
  const SessionTable::TimePoint start{std::chrono::hours(1)};
  const std::string secret = sessions.Open(MemberId{1}, start);
  EXPECT_TRUE(sessions.IsOpen(secret, start + kSessionIdleMax / 2));
  EXPECT_FALSE(sessions.IsOpen(secret, start + kSessionIdleMax));
  EXPECT_FALSE(sessions.IsOpen("another", start));
}

}  // namespace
}  // namespace tessera
