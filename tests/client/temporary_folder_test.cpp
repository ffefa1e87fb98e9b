#include "client/temporary_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Folders in a $TMPDIR of the test's own.
class TemporaryFolders : public testing::Test {
 protected:
  TemporaryFolders() {
    parent_ = testing::TempDir() + "tmp-XXXXXX";
    EXPECT_NE(::mkdtemp(parent_.data()), nullptr);
    if (const char* set = std::getenv("TMPDIR")) before_ = set;
    ::setenv("TMPDIR", parent_.c_str(), 1);
  }
  ~TemporaryFolders() override {
    if (before_) {
      ::setenv("TMPDIR", before_->c_str(), 1);
    } else {
      ::unsetenv("TMPDIR");
    }
    fs::remove_all(parent_);
  }
  // As a process leaves it that was killed some time ago.
  std::string Leave(const std::string& name) const {
    const std::string path = parent_ + "/" + name;
    fs::create_directories(path + "/coordinator");
    std::ofstream(path + "/coordinator/journal") << "text";
    MakeOld(path);
    return path;
  }
  static void MakeOld(const std::string& path) {
    const timespec old[2] = {{1000000000, 0}, {1000000000, 0}};
    ASSERT_EQ(::utimensat(AT_FDCWD, path.c_str(), old, 0), 0);
  }

  std::string parent_;
  std::optional<std::string> before_;
};

TEST_F(TemporaryFolders, ArePrivateAndGoWithTheirObject) {
  std::string path;
  {
    const auto folder = TemporaryFolder::Make();
    ASSERT_TRUE(folder) << folder.error().message;
    path = folder->path();
    EXPECT_EQ(fs::path(path).parent_path(), parent_);
    struct stat status {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0700u);
    std::ofstream(path + "/file") << "text";
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(TemporaryFolders, ThatKilledProcessesLeftAreRemovedByTheNext) {
  const std::string left = Leave("tessera-local-abcdef"), other = Leave("somebody-else");
  const auto first = TemporaryFolder::Make();
  ASSERT_TRUE(first);
  MakeOld(first->path());
  const auto second = TemporaryFolder::Make();
  ASSERT_TRUE(second);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(other + "/coordinator/journal"));
  EXPECT_TRUE(fs::exists(first->path())) << "it is in use";
}

TEST_F(TemporaryFolders, AreFoundAgainInAFolderWhoseNameEndsWithASlash) {
  const std::string left = Leave("tessera-local-abcdef");
  ::setenv("TMPDIR", (parent_ + "/").c_str(), 1);
  ASSERT_TRUE(TemporaryFolder::Make());
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(TemporaryFolders, OneThatWasJustMadeIsLeftAlone) {
  const std::string fresh = parent_ + "/tessera-local-abcdef";
  fs::create_directory(fresh);
  ASSERT_TRUE(TemporaryFolder::Make());
  EXPECT_TRUE(fs::exists(fresh));
}

}  // namespace
}  // namespace tessera
