#include "coordinator/store/file_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "renderer/util/file.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/small_disk.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct JournalStage {
  // The epochs of the facts in the file: what a start would find.
  Result<std::vector<uint32_t>> Reopen() {
    std::vector<uint32_t> epochs;
    auto opened = FileJournal::Open(
        path, [&](const Fact& fact) { epochs.push_back(std::get<CoordinatorStarted>(fact).epoch); });
    if (!opened) return opened.error();
    journal = std::move(*opened);
    return epochs;
  }
  std::string Bytes() const { return *ReadFile(path, 1 << 20); }
  void Put(const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }
  // A journal of three facts.
  void WriteThree() {
    ASSERT_TRUE(Reopen());
    for (uint32_t epoch = 1; epoch <= 3; ++epoch) {
      journal->Append(CoordinatorStarted{epoch});
      ASSERT_TRUE(journal->Sync());
    }
  }
  static constexpr size_t kHeader = 8, kRecord = 44;

  TemporaryDir directory;
  std::string path = directory / "journal";
  std::unique_ptr<FileJournal> journal;
};

TEST(FileJournal, GivesBackWhatWasSyncedInOrder) {
  JournalStage stage;
  stage.WriteThree();
  EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2, 3));
  stage.journal->Append(CoordinatorStarted{4});
  ASSERT_TRUE(stage.journal->Sync());
  EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2, 3, 4));
}

TEST(FileJournal, NothingIsAcknowledgedIntoAFileThatWasRemoved) {
  JournalStage stage;
  stage.WriteThree();
  const std::string away = stage.path + ".away";
  std::filesystem::rename(stage.path, away);
  std::filesystem::remove(away);
  stage.journal->Append(CoordinatorStarted{4});
  const auto synced = stage.journal->Sync();
  ASSERT_FALSE(synced);
  EXPECT_THAT(synced.error().message, HasSubstr("/journal: was removed while it is in use"));
}

TEST(FileJournal, WhatWasNotSyncedIsNotThere) {
  JournalStage stage;
  stage.WriteThree();
  stage.journal->Append(CoordinatorStarted{4});
  EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2, 3));
}

TEST(FileJournal, ARecordCutAnywhereIsTakenOffAndWritingGoesOn) {
  JournalStage whole;
  whole.WriteThree();
  const std::string bytes = whole.Bytes();
  ASSERT_EQ(bytes.size(), JournalStage::kHeader + 3 * JournalStage::kRecord);
  for (size_t cut = 1; cut < JournalStage::kRecord; ++cut) {
    JournalStage stage;
    stage.Put(bytes.substr(0, bytes.size() - cut));
    EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2)) << cut;
    stage.journal->Append(CoordinatorStarted{9});
    ASSERT_TRUE(stage.journal->Sync());
    EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2, 9)) << cut;
  }
}

TEST(FileJournal, ATornTailOfOtherBytesIsTakenOff) {
  JournalStage stage;
  stage.WriteThree();
  const std::string bytes = stage.Bytes();
  for (const std::string& tail : {std::string(100, '\0'), std::string(100, '\xff'), std::string("garbage")}) {
    stage.Put(bytes + tail);
    EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2, 3));
    EXPECT_EQ(stage.Bytes(), bytes) << "the tail is cut";
  }
}

TEST(FileJournal, ATornTailIsReportedWithItsPlaceAndSize) {
  JournalStage stage;
  stage.WriteThree();
  const std::string bytes = stage.Bytes();
  stage.Put(bytes + "garbage");
  std::vector<std::string> torn;
  const auto note = [&](const std::string& path, uint64_t offset, uint64_t size) {
    torn.push_back(path + " " + std::to_string(offset) + " " + std::to_string(size));
  };
  ASSERT_TRUE(FileJournal::Open(
      stage.path, [](const Fact&) {}, note));
  EXPECT_THAT(torn, ElementsAre(stage.path + " " + std::to_string(bytes.size()) + " 7"));
  ASSERT_TRUE(FileJournal::Open(
      stage.path, [](const Fact&) {}, note));
  EXPECT_EQ(torn.size(), 1u) << "it is gone";
}

TEST(FileJournal, AnyFlippedBitOfTheLastRecordDropsItAlone) {
  JournalStage stage;
  stage.WriteThree();
  const std::string bytes = stage.Bytes();
  for (size_t bit = (bytes.size() - JournalStage::kRecord) * 8; bit < bytes.size() * 8; ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    stage.Put(damaged);
    EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2)) << "bit " << bit;
  }
}

TEST(FileJournal, AnyFlippedBitBeforeAReadableRecordIsRefused) {
  JournalStage stage;
  stage.WriteThree();
  const std::string bytes = stage.Bytes();
  for (size_t bit = 0; bit < (bytes.size() - JournalStage::kRecord) * 8; ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    stage.Put(damaged);
    const auto epochs = stage.Reopen();
    ASSERT_FALSE(epochs) << "bit " << bit;
    EXPECT_THAT(epochs.error().message, HasSubstr(stage.path));
    EXPECT_EQ(stage.Bytes(), damaged) << "a refused journal is left as it is";
  }
}

TEST(FileJournal, TheMessageSaysWhereAndHowToGoOn) {
  JournalStage stage;
  stage.WriteThree();
  std::string bytes = stage.Bytes();
  bytes[JournalStage::kHeader + JournalStage::kRecord + 12] ^= 1;
  stage.Put(bytes);
  EXPECT_THAT(
      stage.Reopen().error().message,
      testing::AllOf(HasSubstr("damaged at byte 52"), HasSubstr("truncate"), HasSubstr("move it away")));
}

// The disk may take the pages of a batch in any order before power fails.
TEST(FileJournal, ABatchThatWasNeverSyncedMayBeTornInItsMiddle) {
  JournalStage stage;
  ASSERT_TRUE(stage.Reopen());
  stage.journal->Append(CoordinatorStarted{1});
  ASSERT_TRUE(stage.journal->Sync());
  for (uint32_t epoch = 2; epoch <= 4; ++epoch) stage.journal->Append(CoordinatorStarted{epoch});
  ASSERT_TRUE(stage.journal->Sync());
  std::string bytes = stage.Bytes();
  bytes[JournalStage::kHeader + JournalStage::kRecord + 24] ^= 1;
  stage.Put(bytes);
  EXPECT_THAT(*stage.Reopen(), ElementsAre(1));
}

TEST(FileJournal, IsReplacedByWhatCountsAndGoesOn) {
  JournalStage stage;
  stage.WriteThree();
  ASSERT_TRUE(stage.journal->Replace({CoordinatorStarted{7}}));
  stage.journal->Append(CoordinatorStarted{8});
  ASSERT_TRUE(stage.journal->Sync());
  EXPECT_THAT(*stage.Reopen(), ElementsAre(7, 8));
}

TEST(FileJournal, AReplacementThatFailsChangesNothing) {
  JournalStage stage;
  stage.WriteThree();
  std::filesystem::create_directories(stage.path + ".new/in-the-way");
  EXPECT_FALSE(stage.journal->Replace({CoordinatorStarted{7}}));
  stage.journal->Append(CoordinatorStarted{8});
  ASSERT_TRUE(stage.journal->Sync());
  EXPECT_THAT(*stage.Reopen(), ElementsAre(1, 2, 3, 8));
}

TEST(FileJournal, IsLargeWhenItHasTwiceTheSizeOfWhatCounts) {
  JournalStage stage;
  ASSERT_TRUE(stage.Reopen());
  const JobEnded fact{JobId{1}, JobState::kFailed, std::string(1 << 20, 'x')};
  const std::vector<Fact> counting(4, fact);
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(stage.journal->IsLarge());
    stage.journal->Append(fact);
    ASSERT_TRUE(stage.journal->Sync());
  }
  EXPECT_TRUE(stage.journal->IsLarge());
  ASSERT_TRUE(stage.journal->Replace(counting));
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(stage.journal->IsLarge());
    stage.journal->Append(fact);
    ASSERT_TRUE(stage.journal->Sync());
  }
  stage.journal->Append(fact);
  ASSERT_TRUE(stage.journal->Sync());
  EXPECT_TRUE(stage.journal->IsLarge());
}

// A journal on a disk that can be filled.
class FullDiskOfJournal : public testing::Test {
 protected:
  void SetUp() override {
    if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
    Open();
  }
  // As a start does, which reads the facts.
  void Open() {
    facts.clear();
    journal.reset();
    auto opened = FileJournal::Open(disk_path + "/journal", [&](const Fact& fact) { facts.push_back(fact); });
    ASSERT_TRUE(opened) << opened.error().message;
    journal = std::move(*opened);
  }
  Result<void> Write(uint64_t job, size_t reason_bytes, Room room) {
    journal->Append(JobEnded{JobId{job}, JobState::kCancelled, std::string(reason_bytes, 'x')});
    return journal->Sync(room);
  }
  std::vector<uint64_t> JobsRead() {
    Open();
    std::vector<uint64_t> jobs;
    for (const Fact& fact : facts) jobs.push_back(Number(std::get<JobEnded>(fact).job));
    return jobs;
  }
  // Fills the disk, and the journal as far as that is possible without its reserve: with facts of job 1.
  void FillAll() {
    disk.Fill();
    while (Write(1, 50'000, Room::kFree)) {
    }
  }

  TemporaryDir directory;
  std::string disk_path = directory / "disk";
  SmallDisk disk{disk_path};
  std::unique_ptr<FileJournal> journal;
  std::vector<Fact> facts;
};

TEST_F(FullDiskOfJournal, ItsReserveTakesWhatFreesSpaceAndNothingElse) {
  FillAll();
  EXPECT_THAT(Write(2, 0, Room::kFree).error().message, HasSubstr("No space left"));
  ASSERT_TRUE(Write(3, 0, Room::kReserve)) << "with what waits before it";
  EXPECT_FALSE(Write(4, 0, Room::kFree));
  std::vector<uint64_t> jobs = JobsRead();
  std::erase(jobs, 1);
  EXPECT_THAT(jobs, ElementsAre(2, 3));
}

TEST_F(FullDiskOfJournal, ItsReserveIsThereForTheNextProcessAndEndsOnce) {
  FillAll();
  Open();
  EXPECT_FALSE(Write(2, 50'000, Room::kFree));
  EXPECT_TRUE(Write(3, 500'000, Room::kReserve));
  Open();
  EXPECT_TRUE(Write(4, 300'000, Room::kReserve));
  EXPECT_FALSE(Write(5, 1'000'000, Room::kReserve));
  std::vector<uint64_t> jobs = JobsRead();
  std::erase(jobs, 1);
  EXPECT_THAT(jobs, ElementsAre(2, 3, 4));
}

TEST_F(FullDiskOfJournal, ItsReserveIsKeptAgainWhenThereIsSpaceAndAfterAReplacement) {
  FillAll();
  ASSERT_TRUE(Write(2, 800'000, Room::kReserve));
  disk.Free();
  ASSERT_TRUE(Write(3, 0, Room::kFree));
  FillAll();
  ASSERT_TRUE(Write(4, 800'000, Room::kReserve));
  disk.Free();
  ASSERT_TRUE(journal->Replace({JobEnded{JobId{5}, JobState::kFailed, ""}}));
  FillAll();
  ASSERT_TRUE(Write(6, 800'000, Room::kReserve));
  EXPECT_EQ(JobsRead().back(), 6u);
}

// The reserve is blocks of the file, so it goes with a tail that is cut off, and is allocated again.
TEST_F(FullDiskOfJournal, ItsReserveSurvivesATornTail) {
  ASSERT_TRUE(Write(1, 0, Room::kFree));
  journal.reset();
  std::ofstream(disk_path + "/journal", std::ios::app) << "garbage";
  disk.Fill();
  Open();
  EXPECT_TRUE(Write(2, 500'000, Room::kReserve));
  EXPECT_THAT(JobsRead(), ElementsAre(1, 2));
}

TEST(FileJournal, OtherFilesAreRefused) {
  JournalStage stage;
  for (const char* bytes : {"", "TSRJ", "TSRJ\1\0\0\0", "some text that is long enough"}) {
    stage.Put(bytes);
    EXPECT_FALSE(stage.Reopen()) << bytes;
  }
}

}  // namespace
}  // namespace tessera
