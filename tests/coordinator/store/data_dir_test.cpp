#include "coordinator/store/data_dir.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/coordinator/store/temporary_dir.h"

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

TEST(DataDir, ADirectoryOfAnotherVersionIsRefusedAndLeftAlone) {
  const TemporaryDir directory;
  ASSERT_TRUE(DataDir::Open(directory / "data"));
  std::ofstream(directory / "data/version") << "tessera-data 1\n";
  const auto opened = DataDir::Open(directory / "data");
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message,
              testing::AllOf(HasSubstr("tessera-data 1"), HasSubstr("another --data-dir")));
}

}  // namespace
}  // namespace tessera
