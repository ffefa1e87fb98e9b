#include "renderer/util/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <thread>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// "hello hello hello" packed by gzip.
constexpr unsigned char kPacked[] = {0x1f, 0x8b, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x03,
                                     0xcb, 0x48, 0xcd, 0xc9, 0xc9, 0x57, 0xc8, 0x40, 0x90, 0x00,
                                     0x80, 0x88, 0xf9, 0xe5, 0x11, 0x00, 0x00, 0x00};

class FileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("tessera_file_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  size_t FileCount() const {
    size_t count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_)) ++count;
    return count;
  }

  fs::path folder_;
};

TEST_F(FileTest, WhatIsWrittenIsRead) {
  const std::string bytes("a\0b\n", 4);
  ASSERT_TRUE(WriteFileAtomically(Path("f"), bytes).has_value());
  const Result<std::string> read = ReadFile(Path("f"), 4);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(*read, bytes);
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(FileTest, AnExistingFileIsReplacedWhole) {
  ASSERT_TRUE(WriteFileAtomically(Path("f"), "a long first version").has_value());
  ASSERT_TRUE(WriteFileAtomically(Path("f"), "second").has_value());
  EXPECT_EQ(*ReadFile(Path("f"), 100), "second");
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(FileTest, AFailedWriteLeavesNothingBehind) {
  fs::create_directories(Path("taken/inner"));  // a folder that no file can replace
  const Result<void> result = WriteFileAtomically(Path("taken"), "bytes");
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().message.find(Path("taken")), std::string::npos);
  EXPECT_EQ(FileCount(), 1u);
  EXPECT_FALSE(WriteFileAtomically(Path("none/f"), "bytes").has_value());
}

TEST_F(FileTest, UnreadableThingsAreToldByTheirPath) {
  EXPECT_EQ(ReadFile(Path("none"), 10).error().message,
            Path("none") + ": cannot be opened: No such file or directory");
  EXPECT_EQ(ReadFile(folder_.string(), 10).error().message, folder_.string() + ": is not a regular file");
  ASSERT_TRUE(WriteFileAtomically(Path("f"), "12345").has_value());
  EXPECT_EQ(ReadFile(Path("f"), 4).error().message, Path("f") + ": holds 5 bytes, more than the limit of 4");
  EXPECT_EQ(ReadFile(Path("f"), 4).error().kind, ErrorKind::kBadInput);
}

TEST_F(FileTest, APipeIsRefusedWithoutWaitingForAWriter) {
  ASSERT_EQ(::mkfifo(Path("pipe").c_str(), 0600), 0);
  EXPECT_FALSE(ReadFile(Path("pipe"), 10).has_value());
}

TEST(Gunzip, UnpacksWhole) {
  const std::string_view packed(reinterpret_cast<const char*>(kPacked), sizeof kPacked);
  EXPECT_EQ(*Gunzip(packed, "f.gz", 17), "hello hello hello");
  EXPECT_EQ(Gunzip(packed, "f.gz", 16).error().message, "f.gz: unpacks to more than the limit of 16 bytes");
}

std::string Zipped(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

TEST(Gunzip, StopsAtTheSizeThatTheFileCanReasonablyHave) {
  const std::string bomb = Zipped(std::string(kGunzipFloor + 1, ' '));  // some 16 kB
  EXPECT_EQ(Gunzip(bomb, "f.gz", uint64_t{4} << 30).error().message,
            "f.gz: unpacks to more than the limit of 16777216 bytes for a file of its size");
  const std::string blank(kGunzipFloor, ' ');
  EXPECT_EQ(*Gunzip(Zipped(blank), "f.gz", uint64_t{4} << 30), blank);
  // Of bytes that do not shrink, a larger file is fine.
  std::mt19937 engine(1);
  std::string noise(kGunzipFloor + 1000, ' ');
  for (char& c : noise) c = static_cast<char>(engine());
  EXPECT_EQ(Gunzip(Zipped(noise), "f.gz", uint64_t{4} << 30)->size(), noise.size());
}

TEST(Gunzip, UnpacksAllMembersOfAFile) {
  const std::string one = Zipped("one "), two = Zipped("two ");
  EXPECT_EQ(*Gunzip(one + two + one, "f.gz", 100), "one two one ");
  EXPECT_EQ(Gunzip(one + two, "f.gz", 7).error().message, "f.gz: unpacks to more than the limit of 7 bytes");
  const char* const message = "f.gz: the compressed data is damaged or cut short";
  EXPECT_EQ(Gunzip(one + two.substr(0, two.size() - 1), "f.gz", 100).error().message, message);
  EXPECT_EQ(Gunzip(one + "and text", "f.gz", 100).error().message, message);
}

TEST(Gunzip, DamageIsToldByThePath) {
  const std::string packed(reinterpret_cast<const char*>(kPacked), sizeof kPacked);
  const char* const message = "f.gz: the compressed data is damaged or cut short";
  for (size_t length = 0; length < packed.size(); ++length) {
    EXPECT_EQ(Gunzip(packed.substr(0, length), "f.gz", 100).error().message, message) << length;
  }
  std::string damaged = packed;
  damaged[packed.size() - 6] = static_cast<char>(damaged[packed.size() - 6] ^ 1);  // in the checksum
  EXPECT_EQ(Gunzip(damaged, "f.gz", 100).error().message, message);
  EXPECT_EQ(Gunzip("not packed at all", "f.gz", 100).error().message, message);
}

TEST_F(FileTest, WritersOfOneFileDoNotDisturbEachOther) {
  const std::string whole(1 << 20, 'a'), other(1 << 20, 'b');
  std::thread first([&] {
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(WriteFileAtomically(Path("f"), whole));
  });
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(WriteFileAtomically(Path("f"), other));
  first.join();
  const auto bytes = ReadFile(Path("f"), whole.size());
  ASSERT_TRUE(bytes);
  EXPECT_TRUE(*bytes == whole || *bytes == other);
  EXPECT_EQ(ListFolder(Path(""))->size(), 1u);
}

TEST_F(FileTest, AFolderIsListed) {
  ASSERT_TRUE(WriteFileAtomically(Path("f"), "text"));
  ASSERT_TRUE(CreateFolders(Path("a")));
  auto paths = ListFolder(Path(""));
  ASSERT_TRUE(paths);
  std::ranges::sort(*paths);
  EXPECT_EQ(*paths, (std::vector<std::string>{Path("a"), Path("f")}));
  EXPECT_TRUE(ListFolder(Path("none"))->empty());
  EXPECT_THAT(ListFolder(Path("f")).error().message,
              testing::HasSubstr("f: cannot be listed: Not a directory"));
}

TEST_F(FileTest, FoldersAreCreatedWithThoseAboveThem) {
  ASSERT_TRUE(CreateFolders(Path("a/b/c")));
  EXPECT_TRUE(fs::is_directory(Path("a/b/c")));
  EXPECT_TRUE(CreateFolders(Path("a/b/c/"))) << "it is there";
  ASSERT_TRUE(WriteFileAtomically(Path("f"), ""));
  EXPECT_FALSE(CreateFolders(Path("f/g")));
  EXPECT_FALSE(CreateFolders(Path("f")));
}

TEST_F(FileTest, AFolderThatCannotBeSyncedIsAnError) {
  EXPECT_TRUE(SyncFolder(folder_.string()));
  const auto synced = SyncFolder(Path("missing"));
  ASSERT_FALSE(synced);
  EXPECT_NE(synced.error().message.find("missing"), std::string::npos);
}

}  // namespace
}  // namespace tessera
