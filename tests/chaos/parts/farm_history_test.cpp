#include "tests/chaos/farm_history.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

void RestoreFarm(FarmHistory& history, int farm) {
  history.BeginChange();
  history.NoteRestored(farm);
  history.EndChange();
}

TEST(FarmHistory, AJobFromBeforeTheBackupSurvivesARestoreAndALaterOneIsLost) {
  FarmHistory history;
  const auto before = history.Now(0);
  history.NoteBackup(0);
  const auto after = history.Now(0);
  EXPECT_FALSE(history.IsLost(after));
  RestoreFarm(history, 0);
  EXPECT_FALSE(history.IsLost(before));
  EXPECT_TRUE(history.IsLost(after));
}

TEST(FarmHistory, AJobFromAfterARestoreIsLostWithTheNextRestoreOfTheSameBackup) {
  FarmHistory history;
  history.NoteBackup(0);
  RestoreFarm(history, 0);
  const auto job = history.Now(0);
  EXPECT_FALSE(history.IsLost(job));
  RestoreFarm(history, 0);
  EXPECT_TRUE(history.IsLost(job));
}

TEST(FarmHistory, ALaterBackupHasTheJob) {
  FarmHistory history;
  history.NoteBackup(0);
  const auto job = history.Now(0);
  history.NoteBackup(0);
  RestoreFarm(history, 0);
  EXPECT_FALSE(history.IsLost(job));
}

TEST(FarmHistory, TheOtherFarmLosesNothing) {
  FarmHistory history;
  history.NoteBackup(0);
  history.NoteBackup(1);
  const auto job = history.Now(1);
  RestoreFarm(history, 0);
  EXPECT_FALSE(history.IsLost(job));
}

TEST(FarmHistory, ChangesAreOddWhileTheyLast) {
  FarmHistory history;
  const uint64_t before = history.change();
  EXPECT_EQ(before % 2, 0u);
  history.BeginChange();
  EXPECT_EQ(history.change() % 2, 1u);
  history.EndChange();
  EXPECT_EQ(history.change() % 2, 0u);
  EXPECT_NE(history.change(), before);
}

}  // namespace
}  // namespace tessera
