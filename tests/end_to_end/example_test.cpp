// The example program renders the same picture as tessera.
#include <gtest/gtest.h>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using Example = EndToEnd;

TEST_F(Example, TwoHalvesOfTheSamplesGiveThePictureOfARender) {
  const Outcome example = RunProgram(folder(), "render_unit", {BoxScene(), "example.exr"});
  ASSERT_EQ(example.code, 0) << example.errors;
  Oracle(BoxScene(), {"--spp", "16"});
  const Outcome compared = Tessera({"compare", "example.exr", "oracle.exr"});
  EXPECT_EQ(compared.code, 0) << compared.output << compared.errors;
  EXPECT_NE(compared.output.find("identical=yes"), std::string::npos) << compared.output;
  Oracle(BoxScene(), {"--spp", "8"});
  EXPECT_EQ(Tessera({"compare", "example.exr", "oracle.exr"}).code, 1) << "of half of the samples";
}

TEST_F(Example, ReportsABadScene) {
  const Outcome example = RunProgram(folder(), "render_unit", {Write("bad.pbrt", "Shape 1"), "example.exr"});
  EXPECT_EQ(example.code, 2);
  EXPECT_NE(example.errors.find("bad.pbrt:1:"), std::string::npos) << example.errors;
  EXPECT_FALSE(Exists("example.exr"));
}

}  // namespace
}  // namespace tessera
