// How much a scene may describe.
#include <gtest/gtest.h>

#include "renderer/description/description_builder.h"

namespace tessera::description_size {
namespace {

constexpr uint64_t kMiB = uint64_t{1} << 20;

std::string ErrorOf(DescriptionBuilder& builder, uint64_t size) {
  SourceLocation where = builder.top();
  where.line = 7;
  builder.Charge(where, size);
  const std::optional<Error>& error = builder.diagnostics().error();
  return error ? error->message : "";
}

TEST(DescriptionSize, FollowsTheSizeOfTheFiles) {
  DescriptionBuilder small("a.pbrt");
  small.CountFile(kMiB);
  EXPECT_EQ(ErrorOf(small, 512 * kMiB), "");
  EXPECT_EQ(ErrorOf(small, 1),
            "a.pbrt:7:1: the scene describes more than 536870912 bytes of data, the limit for files of "
            "1048576 bytes");
  DescriptionBuilder larger("a.pbrt");
  larger.CountFile(4 * kMiB);
  EXPECT_EQ(ErrorOf(larger, 800 * kMiB), "");
  EXPECT_NE(ErrorOf(larger, 1), "");
}

TEST(DescriptionSize, OfScenesThatAreNotTextHasOneLimit) {
  DescriptionBuilder values("values");
  EXPECT_EQ(ErrorOf(values, kDescriptionSizeMax), "");
  EXPECT_NE(ErrorOf(values, 1), "");
}

}  // namespace
}  // namespace tessera::description_size
