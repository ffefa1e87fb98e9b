#include "coordinator/store/data_dir.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "proto/shell/pause.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/small_disk.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(DataDir, BelongsToOneProcessAtATime) {
  const TemporaryDir directory;
  {
    const auto first = DataDir::Open(directory / "data");
    ASSERT_TRUE(first);
    const auto second = DataDir::Open(directory / "data");
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message, HasSubstr("another tessera-coordinator"));
  }
  EXPECT_TRUE(DataDir::Open(directory / "data"));
}

TEST(DataDir, AProcessThatIsEndingIsWaitedForALittle) {
  const TemporaryDir directory;
  std::optional<DataDir> first;
  {
    auto opened = DataDir::Open(directory / "data");
    ASSERT_TRUE(opened);
    first.emplace(std::move(*opened));
  }
  const std::jthread ending([&] {
    Pause({}, std::chrono::milliseconds(200));
    first.reset();
  });
  EXPECT_TRUE(DataDir::Open(directory / "data"));
}

TEST(DataDir, TheLockIsNotFreedByRemovingItsFile) {
  const TemporaryDir directory;
  const auto first = DataDir::Open(directory / "data");
  ASSERT_TRUE(first);
  ASSERT_TRUE(std::filesystem::remove(directory / "data/lock"));
  const auto second = DataDir::Open(directory / "data");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("another tessera-coordinator"));
}

TEST(DataDir, IsPrivateToItsUser) {
  const TemporaryDir directory;
  std::filesystem::create_directory(directory / "data");
  std::filesystem::permissions(directory / "data", std::filesystem::perms(0755));
  ASSERT_TRUE(DataDir::Open(directory / "data"));
  EXPECT_EQ(std::filesystem::status(directory / "data").permissions(), std::filesystem::perms::owner_all);
}

TEST(DataDir, ADirectoryWhoseJournalIsGoneIsRefusedUnlessTheUserWantsToStartAfresh) {
  const TemporaryDir directory;
  {
    const auto opened = DataDir::Open(directory / "data");
    ASSERT_TRUE(opened) << "a new folder needs none";
    std::ofstream(opened->JournalPath()) << "facts";
    ASSERT_TRUE(opened->MarkUsed());
  }
  EXPECT_TRUE(DataDir::Open(directory / "data"));
  std::filesystem::remove(directory / "data/journal");
  const auto refused = DataDir::Open(directory / "data");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              testing::AllOf(HasSubstr("its journal is missing"), HasSubstr("--start-afresh")));
  EXPECT_TRUE(DataDir::Open(directory / "data", DataDir::Journal::kMayBeGone));
}

TEST(DataDir, ADirectoryOfAnotherVersionIsRefusedAndLeftAlone) {
  const TemporaryDir directory;
  ASSERT_TRUE(DataDir::Open(directory / "data"));
  std::ofstream(directory / "data/version") << "tessera-data 1\n";
  const auto opened = DataDir::Open(directory / "data");
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message,
              testing::AllOf(HasSubstr("tessera-data 1"), HasSubstr("another --data-dir")));
}

TEST(DataDir, WhatIsBeingSentIsKeptWithoutANameAndLeavesRoomForResults) {
  const TemporaryDir directory;
  const SmallDisk disk(directory / "small");
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const auto data = DataDir::Open(directory / "small/data");
  ASSERT_TRUE(data);
  const auto files = [&] {
    return std::distance(std::filesystem::directory_iterator(directory / "small/data"), {});
  };
  const auto files_before = files();
  const uint64_t total = std::filesystem::space(directory / "small").capacity;
  const std::string most(total * 3 / 4, 'x'), rest(total / 4 - total / 100, 'x');
  {
    const auto kept = data->KeepForSending(most);
    ASSERT_TRUE(kept) << kept.error().message;
    EXPECT_EQ(kept->size(), most.size());
    EXPECT_EQ(files(), files_before);
    EXPECT_TRUE(data->CheckSpace(0));
    const auto refused = data->KeepForSending(rest);
    ASSERT_FALSE(refused) << "it would fit, and leave a hundredth of the disk";
    EXPECT_THAT(refused.error().message,
                testing::AllOf(HasSubstr("small/data: no room for a copy of"), HasSubstr("to send")));
  }
  EXPECT_TRUE(data->KeepForSending(rest)) << "the room is free again";
}

}  // namespace
}  // namespace tessera
