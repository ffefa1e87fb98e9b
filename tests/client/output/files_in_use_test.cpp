#include "client/output/files_in_use.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FilesOfACommand : public testing::Test {
 protected:
  FilesOfACommand() {
    fs::create_directory(folder_ + "/sub");
    std::ofstream(folder_ + "/scene.pbrt") << "scene";
    fs::create_symlink("scene.pbrt", folder_ + "/link");
    fs::create_hard_link(folder_ + "/scene.pbrt", folder_ + "/second");
    fs::create_directory_symlink("sub", folder_ + "/alias");
    fs::create_symlink("sub/new.exr", folder_ + "/dangling");
  }
  const TemporaryDir temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(FilesOfACommand, AreNotOverwrittenByItsOutputsHoweverTheyAreSpelled) {
  FilesInUse files;
  files.AddInput(folder_ + "/scene.pbrt");
  files.AddInput(folder_ + "/gone.pbrt");
  for (const char* name : {"/scene.pbrt", "/./scene.pbrt", "/sub/../scene.pbrt", "//link", "/second"}) {
    const auto added = files.AddOutput(folder_ + name);
    ASSERT_FALSE(added) << name;
    EXPECT_EQ(added.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(added.error().message, HasSubstr("the command reads this file")) << name;
  }
  EXPECT_TRUE(files.AddOutput(folder_ + "/other.exr"));
}

TEST_F(FilesOfACommand, TakeEachOutputOnce) {
  for (const auto& [first, second] :
       std::vector<std::pair<std::string, std::string>>{{"/a.exr", "/a.exr"},
                                                        {"/sub/new.exr", "/alias/new.exr"},
                                                        {"/dangling", "/sub/new.exr"},
                                                        {"/a.exr", "/sub/../a.exr"},
                                                        {"/scene.pbrt", "/link"}}) {
    FilesInUse files;
    ASSERT_TRUE(files.AddOutput(folder_ + first)) << first;
    const auto added = files.AddOutput(folder_ + second);
    ASSERT_FALSE(added) << second;
    EXPECT_THAT(added.error().message, HasSubstr("two pictures would be written to this file"));
  }
  FilesInUse files;
  EXPECT_TRUE(files.AddOutput(folder_ + "/a.exr"));
  EXPECT_TRUE(files.AddOutput(folder_ + "/sub/a.exr"));
}

TEST_F(FilesOfACommand, MayNameADeviceSeveralTimes) {
  FilesInUse files;
  EXPECT_TRUE(files.AddOutput("/dev/null"));
  EXPECT_TRUE(files.AddOutput("/dev/null"));
}

}  // namespace
}  // namespace tessera
