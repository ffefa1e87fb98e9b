// Files that are read in pieces.
#include "renderer/util/readable_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReadableFileTest : public testing::Test {
 protected:
  ReadableFileTest()
      : folder_(fs::temp_directory_path() / ("tessera_readable_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~ReadableFileTest() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Written(const std::string& name, const std::string& bytes) const {
    std::ofstream(Path(name)) << bytes;
    return Path(name);
  }
  static std::string Piece(const ReadableFile& file, uint64_t at, size_t size) {
    std::string bytes(size, '?');
    EXPECT_TRUE(file.Read(at, bytes));
    return bytes;
  }

  const fs::path folder_;
};

TEST_F(ReadableFileTest, ReadsPiecesFromAnyPosition) {
  const auto file = ReadableFile::Open(Written("a", "0123456789"));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size(), 10u);
  EXPECT_EQ(Piece(*file, 4, 3), "456");
  EXPECT_EQ(Piece(*file, 0, 10), "0123456789");
}

TEST_F(ReadableFileTest, KeepsItsBytesWhenAnotherTakesItsName) {
  const auto file = ReadableFile::Open(Written("a", "old"));
  ASSERT_TRUE(file);
  fs::rename(Written("b", "new"), Path("a"));
  EXPECT_EQ(Piece(*file, 0, 3), "old");
  fs::remove(Path("a"));
  EXPECT_EQ(Piece(*file, 0, 3), "old");
}

TEST_F(ReadableFileTest, APieceOfAFileThatWasCutIsShorter) {
  const auto file = ReadableFile::Open(Written("a", "0123456789"));
  ASSERT_TRUE(file);
  fs::resize_file(Path("a"), 6);
  EXPECT_EQ(Piece(*file, 4, 4), "45");
  EXPECT_EQ(Piece(*file, 8, 2), "");
}

TEST_F(ReadableFileTest, WhatIsNoRegularFileIsRefusedByName) {
  ASSERT_EQ(::mkfifo(Path("pipe").c_str(), 0600), 0);
  for (const std::string& path : {Path("missing"), Path("pipe"), folder_.string()}) {
    const auto file = ReadableFile::Open(path);
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(file.error().message, HasSubstr(path + ": "));
  }
}

TEST_F(ReadableFileTest, AFileForWhichThereIsNoDescriptorIsAFailure) {
  const std::string path = Written("a", "text");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const auto file = ReadableFile::Open(path);
  ::setrlimit(RLIMIT_NOFILE, &before);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().kind, ErrorKind::kFailed);
}

TEST_F(ReadableFileTest, AFileThatCannotBeReadIsAnErrorWithTheReason) {
  const ReadableFile file(FileDescriptor(), 3);
  std::string bytes(3, '?');
  const auto read = file.Read(0, bytes);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, "Bad file descriptor");
}

TEST_F(ReadableFileTest, AFileWithoutANameHoldsItsBytesAndIsInNoFolder) {
  const std::string bytes(100'000, 'x');
  auto made = ReadableFile::Nameless(folder_.string(), bytes);
  ASSERT_TRUE(made);
  EXPECT_TRUE(fs::is_empty(folder_));
  const ReadableFile moved = std::move(*made);
  EXPECT_EQ(moved.size(), bytes.size());
  EXPECT_EQ(Piece(moved, 0, bytes.size()), bytes);
  const auto nowhere = ReadableFile::Nameless(Path("missing"), bytes);
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, HasSubstr("cannot be created: No such file"));
}

}  // namespace
}  // namespace tessera
