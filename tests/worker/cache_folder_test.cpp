#include "worker/cache_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::string DefaultWith(const std::map<std::string, std::string>& variables) {
  return DefaultCacheFolder([&](const char* name) {
    const auto found = variables.find(name);
    return found != variables.end() ? found->second : "";
  });
}

mode_t ModeOf(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0);
  return status.st_mode & 07777;
}

TEST(DefaultCacheFolder, ComesFromTheFirstVariableThatIsSet) {
  EXPECT_EQ(DefaultWith({{"XDG_CACHE_HOME", "/x"}, {"CACHE_DIRECTORY", "/c"}, {"HOME", "/h"}}), "/x/tessera");
  EXPECT_EQ(DefaultWith({{"CACHE_DIRECTORY", "/c:/other"}, {"HOME", "/h"}}), "/c");
  EXPECT_EQ(DefaultWith({{"HOME", "/h"}, {"STATE_DIRECTORY", "/s"}}), "/h/.cache/tessera");
  EXPECT_EQ(DefaultWith({{"STATE_DIRECTORY", "/s"}}), "/s/cache");
}

TEST(DefaultCacheFolder, WithoutAHomeIsOneOfThisUser) {
  EXPECT_EQ(DefaultWith({}), "/tmp/tessera-cache-" + std::to_string(::geteuid()));
  EXPECT_EQ(DefaultWith({{"TMPDIR", "/t"}}), "/t/tessera-cache-" + std::to_string(::geteuid()));
}

TEST(OpenCacheFolder, CreatesAPrivateFolder) {
  const TemporaryDir folder;
  ASSERT_TRUE(OpenCacheFolder(folder / "a/b"));
  EXPECT_EQ(ModeOf(folder / "a/b"), 0700u);
}

TEST(OpenCacheFolder, MakesAFolderOfThisUserPrivate) {
  const TemporaryDir folder;
  ASSERT_EQ(::mkdir((folder / "cache").c_str(), 0755), 0);
  ASSERT_TRUE(OpenCacheFolder(folder / "cache"));
  EXPECT_EQ(ModeOf(folder / "cache"), 0700u);
}

TEST(OpenCacheFolder, RefusesAFolderThatOthersMayHavePrepared) {
  const TemporaryDir folder;
  ASSERT_EQ(::mkdir((folder / "cache").c_str(), 0755), 0);
  ASSERT_EQ(::chmod((folder / "cache").c_str(), 0777), 0);
  const auto prepared = OpenCacheFolder(folder / "cache");
  ASSERT_FALSE(prepared);
  EXPECT_THAT(prepared.error().message, HasSubstr("other users may have written"));
}

TEST(OpenCacheFolder, RefusesAFolderOfAnotherUser) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  const TemporaryDir folder;
  ASSERT_EQ(::mkdir((folder / "cache").c_str(), 0700), 0);
  ASSERT_EQ(::chown((folder / "cache").c_str(), 65534, 65534), 0);
  const auto prepared = OpenCacheFolder(folder / "cache");
  ASSERT_FALSE(prepared);
  EXPECT_THAT(prepared.error().message, HasSubstr("belongs to another user (uid 65534)"));
}

TEST(OpenCacheFolder, RefusesLinksAndFiles) {
  const TemporaryDir folder;
  ASSERT_EQ(::mkdir((folder / "elsewhere").c_str(), 0700), 0);
  ASSERT_EQ(::symlink((folder / "elsewhere").c_str(), (folder / "link").c_str()), 0);
  std::ofstream(folder / "file") << "text";
  for (const char* name : {"link", "file"}) {
    const auto prepared = OpenCacheFolder(folder / name);
    ASSERT_FALSE(prepared) << name;
    EXPECT_THAT(prepared.error().message, HasSubstr("is a link or a file"));
  }
}

}  // namespace
}  // namespace tessera
