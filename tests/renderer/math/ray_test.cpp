#include "renderer/math/ray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "renderer/util/hash.h"

namespace tessera {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void ExpectNeighbours(float v) {
  const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
  EXPECT_EQ(bits(NextFloatUp(v)), bits(std::nextafterf(v, kInfinity))) << v;
  EXPECT_EQ(bits(NextFloatDown(v)), bits(std::nextafterf(v, -kInfinity))) << v;
}

TEST(Ray, NextFloatsAreThoseOfTheCLibrary) {
  using Limits = std::numeric_limits<float>;
  for (const float v : {0.0f, 1.0f, Limits::denorm_min(), Limits::min(), Limits::max(), kInfinity}) {
    ExpectNeighbours(v);
    ExpectNeighbours(-v);
  }
  for (uint32_t i = 0; i < 100000; ++i) {
    const float v = std::bit_cast<float>(static_cast<uint32_t>(Hash(7, i)));
    if (!std::isnan(v)) ExpectNeighbours(v);
  }
  EXPECT_TRUE(std::isnan(NextFloatUp(Limits::quiet_NaN())));
}

}  // namespace
}  // namespace tessera
