#include "client/output/output_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "client/output/output_target.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFile : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_ + "/" + name; }
  void Put(const std::string& name, const std::string& text, mode_t mode = 0644) const {
    std::ofstream(Path(name)) << text;
    ASSERT_EQ(::chmod(Path(name).c_str(), mode), 0);
  }
  std::string Text(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(Path(name)).rdbuf();
    return text.str();
  }
  struct stat Status(const std::string& name) const {
    struct stat status {};
    EXPECT_EQ(::lstat(Path(name).c_str(), &status), 0) << name;
    return status;
  }
  size_t FileCount() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  const TemporaryDir temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(OutputFile, AppearsWholeWithTheModeOfTheUmask) {
  ASSERT_TRUE(WriteOutput(Path("a.exr"), "bytes", {}));
  EXPECT_EQ(Text("a.exr"), "bytes");
  const mode_t mask = ::umask(0);
  ::umask(mask);
  EXPECT_EQ(Status("a.exr").st_mode & 0777, 0666 & ~mask);
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(OutputFile, IsKeptIfItExistsAndShallNotBeReplaced) {
  ASSERT_TRUE(WriteOutput(Path("a.exr"), "old", {}, Existing::kKeep)) << "a new file";
  const auto written = WriteOutput(Path("a.exr"), "new", {}, Existing::kKeep);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(written.error().message, HasSubstr("a.exr: exists already"));
  EXPECT_EQ(Text("a.exr"), "old");
  EXPECT_EQ(FileCount(), 1u);
  fs::create_symlink(Path("a.exr"), Path("link.exr"));
  EXPECT_FALSE(WriteOutput(Path("link.exr"), "new", {}, Existing::kKeep));
  ASSERT_TRUE(WriteOutput("/dev/null", "new", {}, Existing::kKeep)) << "a stream replaces nothing";
}

TEST_F(OutputFile, OfTwoProgramsThatKeepFilesOneWrites) {
  std::atomic<int> written = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      if (WriteOutput(Path("a.exr"), std::string(100'000, static_cast<char>('a' + i)), {}, Existing::kKeep))
        ++written;
    });
  }
  for (std::thread& each : threads) each.join();
  EXPECT_EQ(written, 1);
  const std::string text = Text("a.exr");
  EXPECT_EQ(text, std::string(100'000, text.front()));
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(OutputFile, MayHaveTheLongestName) {
  const std::string name(255, 'x');
  ASSERT_TRUE(WriteOutput(Path(name), "bytes", {}));
  EXPECT_EQ(Text(name), "bytes");
}

TEST_F(OutputFile, KeepsTheModeAndOwnerOfTheFileItReplaces) {
  for (const mode_t mode : {0600, 0640, 0755}) {
    Put("a.exr", "a longer text than before", mode);
    if (::geteuid() == 0) {
      ASSERT_EQ(::chown(Path("a.exr").c_str(), 12345, 54321), 0);
    }
    const struct stat before = Status("a.exr");
    ASSERT_TRUE(WriteOutput(Path("a.exr"), "new", {}));
    EXPECT_EQ(Text("a.exr"), "new");
    EXPECT_EQ(Status("a.exr").st_mode, before.st_mode);
    EXPECT_EQ(Status("a.exr").st_uid, before.st_uid);
    EXPECT_EQ(Status("a.exr").st_gid, before.st_gid);
  }
  EXPECT_EQ(FileCount(), 1u);
}

TEST_F(OutputFile, IsWrittenThroughLinks) {
  fs::create_directory(Path("store"));
  Put("store/real.exr", "old", 0600);
  fs::create_symlink("store/real.exr", Path("near.exr"));
  fs::create_symlink(Path("near.exr"), Path("far.exr"));
  ASSERT_TRUE(WriteOutput(Path("far.exr"), "new", {}));
  EXPECT_TRUE(fs::is_symlink(Path("near.exr")));
  EXPECT_TRUE(fs::is_symlink(Path("far.exr")));
  EXPECT_EQ(Text("store/real.exr"), "new");
  EXPECT_EQ(Status("store/real.exr").st_mode & 0777, 0600u);
}

TEST_F(OutputFile, IsMadeWhereALinkLeadsToNothing) {
  fs::create_directory(Path("store"));
  fs::create_symlink("store/new.exr", Path("link.exr"));
  ASSERT_TRUE(WriteOutput(Path("link.exr"), "new", {}));
  EXPECT_TRUE(fs::is_symlink(Path("link.exr")));
  EXPECT_EQ(Text("store/new.exr"), "new");
  fs::create_symlink("loop", Path("loop"));
  EXPECT_THAT(WriteOutput(Path("loop"), "new", {}).error().message, HasSubstr("too many links"));
}

TEST_F(OutputFile, KeepsAllItsNames) {
  Put("a.exr", "a longer text than the new one");
  fs::create_hard_link(Path("a.exr"), Path("b.exr"));
  ASSERT_TRUE(WriteOutput(Path("a.exr"), "new", {}));
  EXPECT_EQ(Text("b.exr"), "new");
  EXPECT_EQ(Status("a.exr").st_ino, Status("b.exr").st_ino);
}

TEST_F(OutputFile, ThatIsReadOnlyIsRefusedToEveryUser) {
  Put("a.exr", "protected", 0444);
  const auto written = WriteOutput(Path("a.exr"), "new", {});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(written.error().message, Path("a.exr") + ": is read-only");
  EXPECT_EQ(Text("a.exr"), "protected");
}

TEST_F(OutputFile, IsStreamedToAPipe) {
  ASSERT_EQ(::mkfifo(Path("pipe").c_str(), 0600), 0);
  const std::string bytes(300'000, 'x');
  std::string read;
  std::thread reader([&] {
    std::ostringstream text;
    text << std::ifstream(Path("pipe")).rdbuf();
    read = text.str();
  });
  const auto written = WriteOutput(Path("pipe"), bytes, {});
  reader.join();
  EXPECT_TRUE(written) << written.error().message;
  EXPECT_EQ(read.size(), bytes.size());
  EXPECT_TRUE(S_ISFIFO(Status("pipe").st_mode));
}

TEST_F(OutputFile, DoesNotWaitForTheReaderOfAPipeAfterAStop) {
  ASSERT_EQ(::mkfifo(Path("pipe").c_str(), 0600), 0);
  std::stop_source stop;
  stop.request_stop();
  const auto written = WriteOutput(Path("pipe"), "bytes", stop.get_token());
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kInterrupted);
}

TEST_F(OutputFile, ThatIsADeviceStaysADevice) {
  fs::create_symlink("/dev/null", Path("null"));
  for (const std::string& path : {std::string("/dev/null"), Path("null")}) {
    ASSERT_TRUE(WriteOutput(path, "bytes", {}));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
  }
  EXPECT_TRUE(fs::is_symlink(Path("null")));
  EXPECT_THAT(WriteOutput("/dev/full", "bytes", {}).error().message, HasSubstr("No space left"));
}

TEST_F(OutputFile, MayBeAnOpenFileOfThisProcess) {
  const int file = ::open(Path("log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ASSERT_EQ(::write(file, "before ", 7), 7);
  ASSERT_TRUE(WriteOutput("/dev/fd/" + std::to_string(file), "bytes", {}));
  EXPECT_EQ(Text("log"), "before bytes");
  ::close(file);
  EXPECT_THAT(WriteOutput("/dev/fd/" + std::to_string(file), "bytes", {}).error().message,
              HasSubstr("is not open"));
  EXPECT_TRUE(IsStandardOutput("-"));
  EXPECT_FALSE(IsStandardOutput("./-"));
  EXPECT_TRUE(IsStandardOutput("/dev/stdout"));
  EXPECT_TRUE(IsStandardOutput("/proc/self/fd/1"));
  EXPECT_FALSE(IsStandardOutput("/dev/stderr"));
  EXPECT_FALSE(IsStandardOutput(Path("log")));
}

TEST_F(OutputFile, IsRefusedWhereNoFileCanBe) {
  EXPECT_THAT(ExamineOutput(folder_).error().message, HasSubstr("is a folder"));
  EXPECT_THAT(ExamineOutput(Path("none/a.exr")).error().message,
              HasSubstr("the folder " + Path("none") + " does not exist"));
  EXPECT_THAT(ExamineOutput(Path("a.exr/")).error().message, HasSubstr("does not exist"));
  Put("file", "");
  EXPECT_FALSE(ExamineOutput(Path("file/a.exr")));
}

}  // namespace
}  // namespace tessera
