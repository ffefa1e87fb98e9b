#include "renderer/math/random_stream.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace tessera {
namespace {

TEST(VectorHash, DependsOnEveryComponentAndTheirOrder) {
  std::set<uint64_t> seen;
  const float values[] = {0, 1, -1.5f};
  for (int n = 0; n < 729; ++n) {
    const auto digit = [&](int place) { return values[n / static_cast<int>(std::pow(3, place)) % 3]; };
    seen.insert(Hash(Vec3{digit(0), digit(1), digit(2)}, Vec3{digit(3), digit(4), digit(5)}));
  }
  EXPECT_EQ(seen.size(), 729u);
}

TEST(VectorHash, ExtendsOtherHashes) {
  const Vec3 a{1, 2, 3}, b{4, 5, 6};
  EXPECT_NE(ExtendHash(Hash(7), a, b), ExtendHash(Hash(8), a, b));
  EXPECT_EQ(ExtendHash(0, a, b), Hash(a, b));
}

TEST(RandomStream, IsAFunctionOfItsSeed) {
  RandomStream a(5), b(5), c(6);
  const float first = a.Next();
  EXPECT_EQ(first, b.Next());
  EXPECT_NE(first, c.Next());
  EXPECT_NE(first, a.Next());
}

TEST(RandomStream, IsUniformAndUncorrelated) {
  RandomStream stream(1);
  constexpr int kCount = 100000;
  double sum = 0, products = 0;
  for (int n = 0; n < kCount; ++n) {
    const Point2 u = stream.Next2();
    ASSERT_GE(u.x, 0);
    ASSERT_LT(u.x, 1);
    sum += u.x;
    products += (u.x - 0.5) * (u.y - 0.5);
  }
  // Standard errors 0.0009 and 0.00026.
  EXPECT_NEAR(sum / kCount, 0.5, 0.004);
  EXPECT_NEAR(products / kCount, 0, 0.0012);
}

}  // namespace
}  // namespace tessera
