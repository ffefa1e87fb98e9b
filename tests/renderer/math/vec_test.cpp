#include "renderer/math/vec.h"

#include <gtest/gtest.h>

#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/math/float4.h"
#include "renderer/math/packed3.h"
#include "renderer/math/sampling.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

Vec3 RandomDirection(TestRandom& random) {
  return SampleUniformSphere(random.Next2<Point2>());
}

TEST(Vec, CrossProductIsRightHandedAndOrthogonal) {
  EXPECT_EQ(Cross({1, 0, 0}, {0, 1, 0}), (Vec3{0, 0, 1}));
  TestRandom random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = RandomDirection(random), b = RandomDirection(random);
    EXPECT_NEAR(Dot(Cross(a, b), a), 0, 1e-6f);
    EXPECT_NEAR(Dot(Cross(a, b), b), 0, 1e-6f);
  }
}

TEST(Vec, DifferenceOfProductsDoesNotCancel) {
  // 4097^2 - 4096 * 4098 = 1, where every product rounds.
  EXPECT_EQ(DifferenceOfProducts(4097, 4097, 4096, 4098), 1);
  const float a = 1 + 0x1p-12f, b = 1 - 0x1p-12f;
  EXPECT_EQ(DifferenceOfProducts(a, b, 1, 1), -0x1p-24f);
}

TEST(Vec, AnglesAreAccurateNearZeroAndPi) {
  const Vec3 z{0, 0, 1};
  EXPECT_NEAR(AngleBetween(z, {1, 0, 0}), kPi / 2, 1e-6f);
  EXPECT_NEAR(AngleBetween(z, Normalize({1e-4f, 0, 1})), 1e-4f, 1e-9f);
  EXPECT_NEAR(AngleBetween(z, Normalize({1e-4f, 0, -1})), kPi - 1e-4f, 1e-6f);
  EXPECT_EQ(AngleBetween(z, z), 0);
  EXPECT_FLOAT_EQ(AngleBetween(z, -z), kPi);
}

TEST(Vec, BasesAreOrthonormalAndRightHanded) {
  TestRandom random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 z = i == 0 ? Vec3{0, 0, -1} : i == 1 ? Vec3{0, 0, 1} : RandomDirection(random);
    for (const Frame& f : {Frame::FromZ(z), Frame::FromXZ(RandomDirection(random), z), Frame::FromXZ(z, z)}) {
      EXPECT_NEAR(Length(f.x), 1, 1e-5f);
      EXPECT_NEAR(Length(f.y), 1, 1e-5f);
      EXPECT_NEAR(Dot(f.x, f.y), 0, 1e-5f);
      EXPECT_NEAR(Dot(f.x, f.z), 0, 1e-5f);
      EXPECT_NEAR(Length(Cross(f.x, f.y) - f.z), 0, 1e-5f);
    }
  }
}

TEST(Vec, FramesTurnVectorsForthAndBack) {
  TestRandom random(3);
  for (int i = 0; i < 1000; ++i) {
    const Frame f = Frame::FromZ(RandomDirection(random));
    const Vec3 v = RandomDirection(random);
    EXPECT_NEAR(Length(f.FromLocal(f.ToLocal(v)) - v), 0, 1e-5f);
    EXPECT_NEAR(f.ToLocal(v).z, Dot(v, f.z), 1e-6f);
  }
}

TEST(Vec, FaceForwardGivesTheNormalOnTheSideOfTheVector) {
  EXPECT_EQ(FaceForward({0, 0, 1}, {1, 0, -1}), (Vec3{0, 0, -1}));
  EXPECT_EQ(FaceForward({0, 0, 1}, {1, 0, 1}), (Vec3{0, 0, 1}));
}

TEST(Bounds, GrowWithTheirPointsAndStartEmpty) {
  Bounds3 b;
  EXPECT_TRUE(b.empty());
  b.Add(Point3{1, 2, 3});
  EXPECT_FALSE(b.empty());
  EXPECT_EQ(b.SurfaceArea(), 0);
  b.Add(Point3{2, 0, 6});
  EXPECT_EQ(b.Diagonal(), (Vec3{1, 2, 3}));
  EXPECT_EQ(b.Center(), (Vec3{1.5f, 1, 4.5f}));
  EXPECT_EQ(b.SurfaceArea(), 22);
  EXPECT_TRUE(b.Contains({1, 0, 6}));
  EXPECT_FALSE(b.Contains({0.9f, 0, 6}));
  EXPECT_EQ(Union(Bounds3(), b).min, b.min);
}

TEST(Float4, WorksElementByElement) {
  const Float4 a(1, -2, 3, 0), b(4, 5, 0, 0);
  const Float4 quotient = SafeDiv(a, b), root = SafeSqrt(a);
  const float expected_quotient[] = {0.25f, -0.4f, 0, 0}, expected_root[] = {1, 0, std::sqrt(3.f), 0};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ((a + b)[i], a[i] + b[i]);
    EXPECT_EQ((a - b)[i], a[i] - b[i]);
    EXPECT_EQ((a * b)[i], a[i] * b[i]);
    EXPECT_EQ((2 * a)[i], 2 * a[i]);
    EXPECT_EQ((-a)[i], -a[i]);
    EXPECT_EQ(Min(a, b)[i], std::min(a[i], b[i]));
    EXPECT_EQ(Max(a, b)[i], std::max(a[i], b[i]));
    EXPECT_EQ(Exp(a)[i], std::exp(a[i]));
    EXPECT_EQ(quotient[i], expected_quotient[i]);
    EXPECT_EQ(root[i], expected_root[i]);
  }
}

TEST(Float4, ReducesInAFixedOrder) {
  const Float4 a(1e8f, 1, -1e8f, 1);
  EXPECT_EQ(Sum(a), (1e8f + 1) + (-1e8f + 1));
  EXPECT_EQ(MaxElement(a), 1e8f);
  EXPECT_EQ(Average(Float4(1, 2, 3, 6)), 3);
  EXPECT_TRUE(AnyNonZero(Float4(0, 0, 1e-40f, 0)));
  EXPECT_FALSE(AnyNonZero(Float4(0, -0.f, 0, 0)));
  EXPECT_TRUE(AllFinite(a));
  EXPECT_FALSE(AllFinite(Float4(0, INFINITY, 0, 0)));
  EXPECT_FALSE(AllFinite(Float4(0, 0, 0, NAN)));
}

TEST(Packed3, HasTheBitsOfTheOperationsOfVectors) {
  TestRandom random(5);
  std::vector<Vec3> vectors = {{0, 0, 0}, {1, -0.0f, 0.0f}, {-1, 0.5f, 1e-20f}, {1e18f, -1e18f, 3}};
  for (int i = 0; i < 100; ++i) vectors.push_back(RandomDirection(random) * (1 + 100 * random.Next()));
  for (const Vec3 a : vectors) {
    for (const Vec3 b : vectors) {
      const Packed3 p = Packed3::Load(a), q(b);
      EXPECT_EQ((p + q).Unpack(), a + b);
      EXPECT_EQ((p - q).Unpack(), a - b);
      EXPECT_EQ((-p).Unpack(), -a);
      EXPECT_EQ((p * b.x).Unpack(), a * b.x);
      EXPECT_EQ((p / 3.0f).Unpack(), a / 3.0f);
      EXPECT_EQ(Abs(p).Unpack(), Abs(a));
      EXPECT_EQ(Min(p, q).Unpack(), Min(a, b));
      EXPECT_EQ(Max(p, q).Unpack(), Max(a, b));
      EXPECT_EQ(Dot(p, q), Dot(a, b));
      EXPECT_EQ(Cross(p, q).Unpack(), Cross(a, b));
      EXPECT_EQ(FaceForward(p, q).Unpack(), FaceForward(a, b));
      if (LengthSquared(a) > 0) {
        EXPECT_EQ(Normalize(p).Unpack(), Normalize(a));
      }
    }
  }
}

}  // namespace
}  // namespace tessera
