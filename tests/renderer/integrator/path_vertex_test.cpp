#include "renderer/integrator/path_vertex.h"

#include <gtest/gtest.h>

#include <limits>

namespace tessera {
namespace {

TEST(Roulette, PathsGoOnInProportionToTheShareThatTheyCarry) {
  EXPECT_FLOAT_EQ(EndProbability(kSureShare / 2, 2), 0.5f);
  EXPECT_FLOAT_EQ(EndProbability(kSureShare / 10, 5), 0.9f);
  EXPECT_EQ(EndProbability(0, 2), 1);
}

TEST(Roulette, SparesTheFirstVertexAndPathsThatCarryMuch) {
  EXPECT_EQ(EndProbability(0.01f, 1), 0);
  EXPECT_EQ(EndProbability(kSureShare, 2), 0);
  EXPECT_EQ(EndProbability(3, 9), 0);
  EXPECT_EQ(EndProbability(std::numeric_limits<float>::quiet_NaN(), 9), 0);
}

}  // namespace
}  // namespace tessera
