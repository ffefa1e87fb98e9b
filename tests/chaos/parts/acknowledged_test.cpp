#include "tests/chaos/acknowledged.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

std::string Line(int second, const std::string& range, const std::string& verdict = "accepted",
                 const std::string& farm = "a1") {
  return "2026-01-01T00:00:0" + std::to_string(second) + ".000+0000 debug result_answered farm=" + farm +
         " unit=\"job 3 frame 0 tile 17 samples " + range + "\" verdict=" + verdict + "\n";
}

size_t Count(const std::string& log) {
  return RenderedAgain(ReadAcknowledgements(log)).size();
}

TEST(Acknowledged, ReadsWhatWorkersLog) {
  const auto all =
      ReadAcknowledgements("something else\n" + Line(1, "[64,128)") + Line(2, "[0,1)", "duplicate"));
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].farm, "a1");
  EXPECT_EQ(all[0].job, 3u);
  EXPECT_EQ(all[0].tile, 17u);
  EXPECT_EQ(all[0].range, (SampleRange{64, 64}));
}

// Both have jobs of the same numbers.
TEST(Acknowledged, ResultsOfDifferentFarmsAreDifferent) {
  EXPECT_EQ(Count(Line(1, "[0,64)") + Line(2, "[0,64)")), 1u);
  EXPECT_EQ(Count(Line(1, "[0,64)") + Line(2, "[0,64)", "accepted", "b2")), 0u);
}

TEST(Acknowledged, WhatARestoredFarmHasLostIsRenderedAgain) {
  auto all = ReadAcknowledgements(Line(1, "[0,64)") + Line(2, "[0,64)"));
  ASSERT_EQ(all.size(), 2u);
  all[1].restores = 1;
  EXPECT_TRUE(RenderedAgain(all).empty());
  all[0].restores = 1;
  EXPECT_EQ(RenderedAgain(all).size(), 1u);
}

TEST(Acknowledged, ALineThatIsCutOffIsNone) {
  const std::string line = Line(1, "[64,128)");
  EXPECT_TRUE(ReadAcknowledgements(line.substr(0, line.size() - 1)).empty());
}

TEST(Acknowledged, WhatIsAcceptedTwiceWasLost) {
  EXPECT_EQ(Count(Line(1, "[0,4)") + Line(2, "[4,8)") + Line(3, "[0,4)")), 1u);
  EXPECT_EQ(Count(Line(1, "[0,4)") + Line(2, "[4,8)") + Line(3, "[0,8)")), 1u) << "in two parts";
  EXPECT_EQ(Count(Line(1, "[0,8)") + Line(2, "[4,8)") + Line(3, "[0,4)")), 1u) << "in both of its parts";
}

TEST(Acknowledged, ALargerResultMayBringMoreThanWasThere) {
  EXPECT_EQ(Count(Line(1, "[0,4)") + Line(2, "[0,8)")), 0u);
  EXPECT_EQ(Count(Line(1, "[0,4)") + Line(2, "[0,2)", "duplicate") + Line(3, "[6,8)") + Line(4, "[0,8)")),
            0u);
}

TEST(Acknowledged, WorkersThatWriteLateSwapTheOrder) {
  EXPECT_EQ(Count(Line(1, "[0,8)") + Line(2, "[0,4)")), 0u);
}

}  // namespace
}  // namespace tessera
