// What is computed in eight lanes has the bits of one after the other.
#include "renderer/math/lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

#include "renderer/math/double_lanes.h"
#include "renderer/math/ray_lanes.h"
#include "renderer/math/sampling.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

using Limits = std::numeric_limits<float>;

// Ordinary numbers, and now and then one at the limits of what floats are.
float AnyFloat(uint32_t i, uint32_t which) {
  constexpr float kSpecial[] = {0.0f, -0.0f,         1.0f,           -1.0f,         1e-30f,
                                3e7f, Limits::max(), -Limits::max(), Limits::min(), Limits::denorm_min()};
  const uint64_t random = Hash(i, which);
  if (random % 8 == 0) return kSpecial[random / 8 % std::size(kSpecial)];
  return 4 * UniformFloatFromHash(random) - 2;
}
Vec3 AnyVector(uint32_t i, uint32_t which) {
  return {AnyFloat(i, 3 * which), AnyFloat(i, 3 * which + 1), AnyFloat(i, 3 * which + 2)};
}

// Arguments of eight lanes.
template <typename T>
using Eight = std::array<T, kLanes>;

Float8 Lanes(const Eight<float>& values) {
  return Float8::Load(values.data());
}
Vec3x8 Lanes(const Eight<Vec3>& values) {
  Eight<float> x, y, z;
  for (int i = 0; i < kLanes; ++i) {
    x[i] = values[i].x;
    y[i] = values[i].y;
    z[i] = values[i].z;
  }
  return {Lanes(x), Lanes(y), Lanes(z)};
}
Eight<float> Unpack(Float8 v) {
  Eight<float> values;
  v.Store(values.data());
  return values;
}
Eight<Vec3> Unpack(const Vec3x8& v) {
  const Eight<float> x = Unpack(v.x), y = Unpack(v.y), z = Unpack(v.z);
  Eight<Vec3> values;
  for (int i = 0; i < kLanes; ++i) values[i] = {x[i], y[i], z[i]};
  return values;
}

// One NaN is like another.
void ExpectSameBits(float actual, float expected) {
  if (std::isnan(expected)) {
    EXPECT_TRUE(std::isnan(actual));
  } else {
    EXPECT_EQ(std::bit_cast<uint32_t>(actual), std::bit_cast<uint32_t>(expected))
        << actual << " " << expected;
  }
}
void ExpectSameBits(Vec3 actual, Vec3 expected) {
  for (int i = 0; i < 3; ++i) ExpectSameBits(actual[i], expected[i]);
}

// Compares function(x, y, z) in lanes with the same one by one, where arguments are made by `make`.
template <typename Make, typename InLanes, typename OneByOne>
void ExpectSame(Make&& make, InLanes&& in_lanes, OneByOne&& one_by_one) {
  using T = decltype(make(0u, 0u));
  for (uint32_t round = 0; round < 4000; ++round) {
    Eight<T> a, b, c;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      const uint32_t i = round * kLanes + lane;
      a[lane] = make(i, 0);
      b[lane] = make(i, 1);
      c[lane] = make(i, 2);
    }
    const auto results = Unpack(in_lanes(Lanes(a), Lanes(b), Lanes(c)));
    for (int lane = 0; lane < kLanes; ++lane)
      ExpectSameBits(results[lane], one_by_one(a[lane], b[lane], c[lane]));
    if (testing::Test::HasFailure()) return;
  }
}
template <typename InLanes, typename OneByOne>
void ExpectSameNumbers(InLanes&& in_lanes, OneByOne&& one_by_one) {
  ExpectSame(AnyFloat, in_lanes, one_by_one);
}
template <typename InLanes, typename OneByOne>
void ExpectSameVectors(InLanes&& in_lanes, OneByOne&& one_by_one) {
  ExpectSame(AnyVector, in_lanes, one_by_one);
}
// For functions that are written once for both.
template <typename Function>
void ExpectSameNumbers(Function&& function) {
  ExpectSameNumbers(function, function);
}
template <typename Function>
void ExpectSameVectors(Function&& function) {
  ExpectSameVectors(function, function);
}

TEST(Lanes, ArithmeticHasTheBitsOfFloats) {
  ExpectSameNumbers([](auto a, auto b, auto c) { return a * b + c; });
  ExpectSameNumbers([](auto a, auto b, auto c) { return -a / b - c; });
  ExpectSameNumbers([](auto a, auto b, auto) { return Sqrt(Abs(a)) + Abs(b); });
  ExpectSameNumbers([](auto a, auto b, auto c) { return Lerp(a, b, c); });
  ExpectSameNumbers([](auto a, auto b, auto c) { return DifferenceOfProducts(a, b, c, a); });
  ExpectSameNumbers([](auto a, auto b, auto c) { return Select(a < b, c, a); });
  ExpectSameNumbers([](auto a, auto b, auto c) { return Select(a <= b, c, a); });
  ExpectSameNumbers([](auto a, auto b, auto c) { return Select(a > b, c, a); });
  ExpectSameNumbers([](auto a, auto b, auto c) { return Select(a == b, c, a); });
  ExpectSameNumbers([](auto a, auto b, auto) { return Min(a, b); });
  ExpectSameNumbers([](Float8 a, Float8 b, Float8) { return Max(a, b); },
                    [](float a, float b, float) { return std::max(a, b); });
  ExpectSameNumbers([](Float8 a, Float8 b, Float8) { return CopySign(a, b); },
                    [](float a, float b, float) { return std::copysign(a, b); });
  ExpectSameNumbers([](Float8 a, Float8, Float8) { return SafeSqrt(a); },
                    [](float a, float, float) { return SafeSqrt(a); });
}

TEST(Lanes, VectorsHaveTheBitsOfVec3) {
  ExpectSameVectors([](auto a, auto b, auto c) { return a + (b - c) * Dot(a, b); });
  ExpectSameVectors([](auto a, auto b, auto c) { return Cross(a, b) + Cross(c, -a); });
  ExpectSameVectors([](auto a, auto b, auto) { return Normalize(a - b); });
  ExpectSameVectors([](auto a, auto b, auto c) { return FaceForward(a, b) + Abs(c); });
  ExpectSameVectors([](auto a, auto b, auto c) { return Max(a, Min(b, c)); });
}

TEST(Lanes, FramesHaveTheBitsOfFrame) {
  ExpectSameVectors([](const Vec3x8& z, auto, auto) { return Frame8(z).x; },
                    [](Vec3 z, Vec3, Vec3) { return Frame::FromZ(z).x; });
  ExpectSameVectors([](const Vec3x8& z, auto, auto) { return Frame8(z).y; },
                    [](Vec3 z, Vec3, Vec3) { return Frame::FromZ(z).y; });
}

TEST(Lanes, RaysStartWhereOneStarts) {
  const auto error = [](auto v) { return Abs(v); };
  ExpectSameVectors([&](auto p, auto n, auto w) { return OffsetRayOrigin(p, error(w), n, w); });
  ExpectSameVectors([&](auto p, auto n, auto w) { return OffsetRayOrigin(p, error(p), -n, n - w); });
}

TEST(Lanes, DoublesHaveTheBitsOfDoubles) {
  ExpectSameNumbers(
      [](Float8 a, Float8 b, Float8 c) {
        return (Double8(a) * Double8(b) - Double8(c) / Double8(a)).ToFloat();
      },
      [](float a, float b, float c) { return static_cast<float>(double{a} * b - double{c} / a); });
  ExpectSameNumbers(
      [](Float8 a, Float8 b, Float8 c) {
        const Double8 low(Min(b, c)), high(Select(b < c, c, b));
        return Min(Clamp(Double8(a), low, high), Double8(c)).ToFloat();
      },
      [](float a, float b, float c) {
        const double clamped = std::clamp<double>(a, std::min(b, c), b < c ? c : b);
        return static_cast<float>(std::min<double>(clamped, c));
      });
  ExpectSameNumbers([](Float8 a, Float8 b, Float8 c) { return Select(Double8(a) > Double8(b), a, c); },
                    [](float a, float b, float c) { return a > b ? a : c; });
  ExpectSameNumbers([](Float8 a, Float8 b, Float8 c) { return Select(Double8(a) == Double8(b), a, c); },
                    [](float a, float b, float c) { return a == b ? a : c; });
}

TEST(Lanes, SamplesHaveTheBitsOfOneSample) {
  ExpectSameNumbers([](auto a, auto b, auto c) { return SampleLinearOf(Abs(a), Abs(b), Abs(c)); });
  ExpectSameNumbers([](auto a, auto b, auto) { return PowerHeuristicOf(Abs(a), Abs(b)); });
  const auto disk = [](auto u, auto v) {
    if constexpr (std::is_same_v<decltype(u), float>) {
      return SampleUniformDiskConcentric({u, v});
    } else {
      return SampleUniformDiskConcentricOf(Vec2x8{u, v});
    }
  };
  ExpectSameNumbers([&](auto u, auto v, auto) { return disk(u, v).x; });
  ExpectSameNumbers([&](auto u, auto v, auto) { return disk(u, v).y; });
}

TEST(Lanes, SetsOfLanesAndMasksAreTheSame) {
  for (LaneSet lanes = 0; lanes <= kAllLanes; ++lanes) {
    EXPECT_EQ(MaskOf(lanes).lanes(), lanes);
    LaneSet visited = 0;
    ForEachLane(lanes, [&](int lane) {
      EXPECT_TRUE(HasLane(lanes, lane));
      visited |= LaneSet{1} << lane;
    });
    EXPECT_EQ(visited, lanes);
    const Eight<float> chosen = Unpack(Select(MaskOf(lanes), Float8(1), Float8(2)));
    for (int lane = 0; lane < kLanes; ++lane) EXPECT_EQ(chosen[lane], HasLane(lanes, lane) ? 1 : 2);
  }
}

TEST(Lanes, RaysAreStoredAsTheyWereLoaded) {
  std::array<Ray, kLanes> rays;
  const Ray* places[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto v = static_cast<float>(lane);
    rays[lane] = {{v, v + 0.1f, v + 0.2f}, {v + 0.3f, v + 0.4f, v + 0.5f}, v + 0.6f, v + 0.7f};
    places[lane] = &rays[lane];
  }
  std::array<Ray, kLanes> stored;
  constexpr LaneSet kSome = 0b10110010;
  Rays8(kSome, places).Store(kAllLanes, [&](int lane) { return &stored[lane]; });
  for (int lane = 0; lane < kLanes; ++lane) {
    const Ray& expected = rays[HasLane(kSome, lane) ? lane : 1];
    EXPECT_EQ(stored[lane].o, expected.o);
    EXPECT_EQ(stored[lane].d, expected.d);
    EXPECT_EQ(stored[lane].t_max, expected.t_max);
    EXPECT_EQ(stored[lane].time, expected.time);
  }
  stored = {};
  Rays8(kAllLanes, places).Store(kSome, [&](int lane) { return &stored[lane]; });
  for (int lane = 0; lane < kLanes; ++lane)
    EXPECT_EQ(stored[lane].o, HasLane(kSome, lane) ? rays[lane].o : Point3());
}

}  // namespace
}  // namespace tessera
