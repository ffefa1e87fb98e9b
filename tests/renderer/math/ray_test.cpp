#include "renderer/math/ray.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <iterator>

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

// As written in the book, one coordinate after the other.
Point3 MovedOrigin(Point3 p, Vec3 error, Normal3 n, Vec3 w) {
  float d = Dot(Abs(n), error);
  if (Dot(w, n) < 0) d = -d;
  const Vec3 offset = n * d;
  Point3 po = p + offset;
  for (int i = 0; i < 3; ++i) {
    if (offset[i] > 0) po[i] = std::nextafterf(po[i], kInfinity);
    if (offset[i] < 0) po[i] = std::nextafterf(po[i], -kInfinity);
  }
  return po;
}

TEST(Ray, OriginsAreMovedAlongTheNormalAndByOneFloatMore) {
  using Limits = std::numeric_limits<float>;
  const float values[] = {
      0.0f,          -0.0f,         1.0f, -1.0f, 1e-20f, -3e7f, Limits::denorm_min(), -Limits::denorm_min(),
      Limits::max(), -Limits::max()};
  constexpr uint64_t kCount = std::size(values);
  for (uint32_t i = 0; i < 100000; ++i) {
    const auto pick = [&](uint32_t which) { return values[Hash(i, which) % kCount]; };
    const auto any = [&](uint32_t which) { return 2 * UniformFloatFromHash(Hash(i, which)) - 1; };
    const Point3 p = i % 2 == 0 ? Point3{pick(0), pick(1), pick(2)} : Point3{any(0), any(1), any(2)};
    const Vec3 error = i % 3 == 0 ? Vec3{} : Vec3{std::abs(any(3)), 1e-7f, std::abs(any(4)) * 1e-30f};
    const Normal3 n = i % 5 == 0 ? Normal3{0, -1, 0} : Normal3{any(5), any(6), any(7)};
    const Vec3 w{any(8), any(9), any(10)};
    const Point3 moved = OffsetRayOrigin(p, error, n, w), expected = MovedOrigin(p, error, n, w);
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(std::bit_cast<uint32_t>(moved[axis]), std::bit_cast<uint32_t>(expected[axis])) << i;
  }
}

}  // namespace
}  // namespace tessera
