#include "renderer/light/light_tree.h"

#include <gtest/gtest.h>

#include <numeric>

#include "renderer/math/sampling.h"
#include "tests/chi_square.h"
#include "tests/renderer/light/light_scene.h"

namespace tessera {
namespace {

struct Triangle {
  Point3 p[3];
  Normal3 Normal() const { return Normalize(Cross(p[1] - p[0], p[2] - p[0])); }
  float Area() const { return Length(Cross(p[1] - p[0], p[2] - p[0])) / 2; }
  Point3 Center() const { return (p[0] + p[1] + p[2]) / 3; }
};

Vec3 InBox(TestRandom& random, float size) {
  const float x = random.Next();
  const float y = random.Next();
  const float z = random.Next();
  return {(x - 0.5f) * size, (y - 0.5f) * size, (z - 0.5f) * size};
}

std::vector<Triangle> RandomTriangles(size_t count, uint64_t seed) {
  TestRandom random(seed);
  std::vector<Triangle> triangles(count);
  for (Triangle& t : triangles) {
    const Point3 center = InBox(random, 10);
    for (Point3& p : t.p) p = center + InBox(random, 0.5f);
  }
  return triangles;
}

std::vector<LightBounds> BoundsOf(const std::vector<Triangle>& triangles, bool two_sided) {
  std::vector<LightBounds> all;
  for (const Triangle& t : triangles) {
    LightBounds bounds;
    for (const Point3 p : t.p) bounds.box.Add(p);
    bounds.axis = t.Normal();
    bounds.cos_theta_e = 0;
    bounds.strength = t.Area();
    bounds.two_sided = two_sided;
    if (!two_sided) bounds.plane_min = Dot(bounds.axis, t.p[0]) - 1e-4f;
    all.push_back(bounds);
  }
  return all;
}

std::vector<uint32_t> Indices(size_t count) {
  std::vector<uint32_t> indices(count);
  std::iota(indices.begin(), indices.end(), 0u);
  return indices;
}

LightTree TreeOf(const std::vector<LightBounds>& bounds) {
  return LightTree(bounds, Indices(bounds.size()), bounds.size());
}

TEST(LightTree, ProbabilitiesSumToOneOrNothingArrives) {
  const LightTree tree = TreeOf(BoundsOf(RandomTriangles(500, 1), true));
  TestRandom random(2);
  for (int i = 0; i < 20; ++i) {
    const Point3 p = InBox(random, 15);
    const Normal3 n = SampleUniformSphere(random.Next2<Point2>());
    double total = 0;
    for (int light = 0; light < 500; ++light) total += static_cast<double>(tree.Pmf(At(p, n), light));
    // The share of a branch is lost if none of its lights contributes.
    EXPECT_LT(total, 1 + 1e-4);
    EXPECT_GT(total, 0.9);
  }
}

TEST(LightTree, ProbabilitiesOfLightsSeenFromAllSidesSumToOne) {
  std::vector<LightBounds> bounds = BoundsOf(RandomTriangles(333, 3), true);
  for (LightBounds& b : bounds) b.cos_theta_o = -1;
  const LightTree tree = TreeOf(bounds);
  TestRandom random(4);
  for (int i = 0; i < 20; ++i) {
    const Point3 p = InBox(random, 15);
    double total = 0;
    for (int light = 0; light < 333; ++light) total += static_cast<double>(tree.Pmf(At(p, {}), light));
    EXPECT_NEAR(total, 1, 1e-4);
  }
}

TEST(LightTree, ChooseReturnsThePmf) {
  const LightTree tree = TreeOf(BoundsOf(RandomTriangles(1000, 5), false));
  TestRandom random(6);
  int chosen_count = 0;
  for (int i = 0; i < 5000; ++i) {
    const Point3 p = InBox(random, 12);
    const Normal3 n = SampleUniformSphere(random.Next2<Point2>());
    const std::optional<ChosenLight> chosen = tree.Choose(At(p, n), random.Next());
    if (!chosen) continue;
    ++chosen_count;
    const float pmf = tree.Pmf(At(p, n), chosen->light);
    ASSERT_GT(pmf, 0);
    ASSERT_NEAR(chosen->pmf / pmf, 1, 1e-5f);
  }
  EXPECT_GT(chosen_count, 4000);
}

Ray RandomRay(TestRandom& random) {
  const Point3 origin = InBox(random, 12);
  return {origin, SampleUniformSphere(random.Next2<Point2>())};
}

TEST(LightTree, ProbabilitiesAlongARaySumToOne) {
  const LightTree tree = TreeOf(BoundsOf(RandomTriangles(333, 3), false));
  TestRandom random(4);
  for (int i = 0; i < 20; ++i) {
    const Ray ray = RandomRay(random);
    double total = 0;
    for (int light = 0; light < 333; ++light) total += static_cast<double>(tree.PmfAlong(ray, light));
    EXPECT_NEAR(total, 1, 1e-4);
  }
}

TEST(LightTree, ChooseAlongReturnsThePmf) {
  const LightTree tree = TreeOf(BoundsOf(RandomTriangles(1000, 5), false));
  TestRandom random(6);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = RandomRay(random);
    const std::optional<ChosenLight> chosen = tree.ChooseAlong(ray, random.Next());
    ASSERT_TRUE(chosen);
    ASSERT_NEAR(chosen->pmf / tree.PmfAlong(ray, chosen->light), 1, 1e-5f);
  }
}

TEST(LightTree, SpheresHoldTheirLights) {
  const std::vector<Triangle> triangles = RandomTriangles(100, 7);
  const LightTree tree = TreeOf(BoundsOf(triangles, false));
  for (int light = 0; light < 100; ++light) {
    const BoundingSphere sphere = tree.SphereOf(light);
    for (const Point3 p : triangles[static_cast<size_t>(light)].p)
      EXPECT_LT(Length(p - sphere.center), sphere.radius * 1.0001f);
    EXPECT_LT(sphere.radius, 1);
  }
}

// The integral of 1 / r^2 along a whole line that passes at distance d is pi / d.
TEST(LightTree, ImportanceAlongARayFallsWithTheDistance) {
  std::vector<LightBounds> bounds(2);
  bounds[0].box.Add(Point3{0, 1, 0});
  bounds[1].box.Add(Point3{0, 0, -4});
  for (LightBounds& b : bounds) b.strength = 2;
  const LightTree tree = TreeOf(bounds);
  EXPECT_FLOAT_EQ(tree.PmfAlong({{-100, 0, 0}, {1, 0, 0}}, 0), 4.0f / 5);
  EXPECT_FLOAT_EQ(tree.PmfAlong({{3, 1, 0}, {1, 0, 0}}, 0), std::sqrt(26.0f) / (3 + std::sqrt(26.0f)));
}

TEST(LightTree, FrequenciesMatchTheProbabilities) {
  const LightTree tree = TreeOf(BoundsOf(RandomTriangles(60, 7), true));
  TestRandom random(8);
  const Point3 p{1, 2, -1};
  const Normal3 n{0, 0, 1};
  constexpr int kDraws = 200000;
  std::vector<chi_square::Cell> cells(61);
  double rest = kDraws;
  for (int light = 0; light < 60; ++light) {
    cells[light].expected = static_cast<double>(tree.Pmf(At(p, n), light)) * kDraws;
    rest -= cells[light].expected;
  }
  cells[60].expected = std::max(0.0, rest);
  for (int i = 0; i < kDraws; ++i) {
    const std::optional<ChosenLight> chosen = tree.Choose(At(p, n), random.Next());
    ++cells[chosen ? chosen->light : 60].observed;
  }
  std::string text;
  EXPECT_GT(chi_square::PooledPValue(cells, text), 1e-4) << text;
}

class LightTreeSides : public testing::TestWithParam<bool> {};

TEST_P(LightTreeSides, EveryLightThatReachesAPointCanBeChosen) {
  const std::vector<Triangle> triangles = RandomTriangles(400, 9);
  const bool two_sided = GetParam();
  const LightTree tree = TreeOf(BoundsOf(triangles, two_sided));
  TestRandom random(10);
  for (int i = 0; i < 50; ++i) {
    const Point3 p = InBox(random, 12);
    const Normal3 n = SampleUniformSphere(random.Next2<Point2>());
    for (int light = 0; light < 400; ++light) {
      const Vec3 to_light = triangles[light].Center() - p;
      const Vec3 wi = Normalize(to_light);
      const float cosine = -Dot(wi, triangles[light].Normal());
      const bool lit = (two_sided ? std::abs(cosine) : cosine) > 1e-3f && AbsDot(wi, n) > 1e-3f;
      if (lit) {
        ASSERT_GT(tree.Pmf(At(p, n), light), 0) << light;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OneAndTwo, LightTreeSides, testing::Bool());

// Lights without extent and of equal strength that shine in all directions.
std::vector<LightBounds> PointBounds(const std::vector<Point3>& places) {
  std::vector<LightBounds> bounds(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    bounds[i].box = {places[i], places[i]};
    bounds[i].cos_theta_o = -1;
    bounds[i].cos_theta_e = 0;
    bounds[i].strength = 3;
  }
  return bounds;
}

TEST(LightTree, ImportanceFollowsIrradianceOfSmallLights) {
  // One is twice as far as the other: it contributes a quarter.
  const LightTree tree = TreeOf(PointBounds({{0, 0, 1}, {0, 0, 2}}));
  EXPECT_NEAR(tree.Pmf(At({0, 0, 0}, {}), 0), 0.8f, 1e-5f);
  EXPECT_NEAR(tree.Pmf(At({0, 0, 0}, {0, 0, 1}), 1), 0.2f, 1e-5f);
}

ReferencePoint WithLobe(ReferencePoint reference, Vec3 axis, float alpha) {
  reference.lobe = {axis, alpha * alpha};
  return reference;
}

TEST(LightTree, ALobePrefersLightsAlongItsAxis) {
  const LightTree tree = TreeOf(PointBounds({{0, 0.1f, 3}, {3, 0, 0.1f}}));
  const ReferencePoint reference = At({0, 0, 0}, {0, 0, 1});
  EXPECT_GT(tree.Pmf(WithLobe(reference, {0, 0, 1}, 0.1f), 0), 0.99f);
  EXPECT_GT(tree.Pmf(WithLobe(reference, {1, 0, 0}, 0.1f), 1), 0.99f);
  // A rougher surface scatters more light aside.
  EXPECT_LT(tree.Pmf(WithLobe(reference, {0, 0, 1}, 0.5f), 0), 0.97f);
}

TEST(LightTree, ALobeLeavesEveryLightThatReachesAPointAChance) {
  const std::vector<Triangle> triangles = RandomTriangles(400, 9);
  std::vector<LightBounds> bounds = BoundsOf(triangles, true);
  for (size_t i = 0; i < bounds.size(); i += 2)
    bounds[i].box = {bounds[i].box.Center(), bounds[i].box.Center()};
  const LightTree tree = TreeOf(bounds);
  TestRandom random(10);
  for (int i = 0; i < 50; ++i) {
    const Vec3 axis = SampleUniformSphere(random.Next2<Point2>());
    const Normal3 n = SampleUniformSphere(random.Next2<Point2>());
    const ReferencePoint reference = WithLobe(At(InBox(random, 12), n), axis, 0.001f + random.Next());
    double total = 0;
    for (int light = 0; light < 400; ++light) {
      const float pmf = tree.Pmf(reference, light);
      const Vec3 wi = Normalize(triangles[light].Center() - reference.p);
      if (AbsDot(wi, triangles[light].Normal()) > 1e-3f) {
        ASSERT_GT(pmf, 0) << light;
      }
      total += static_cast<double>(pmf);
    }
    EXPECT_LT(total, 1 + 1e-4);
    const std::optional<ChosenLight> chosen = tree.Choose(reference, random.Next());
    if (chosen) {
      EXPECT_NEAR(chosen->pmf / tree.Pmf(reference, chosen->light), 1, 1e-5f);
    }
  }
}

TEST(LightTree, LightsBehindTheirPlaneAreNotChosen) {
  const std::vector<Triangle> triangles = {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                           {{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}}};
  const LightTree tree = TreeOf(BoundsOf(triangles, false));
  EXPECT_FALSE(tree.Choose(At({0.2f, 0.2f, -0.1f}, {0, 0, 1}), 0.5f));
  EXPECT_TRUE(tree.Choose(At({0.2f, 0.2f, 0.1f}, {0, 0, 1}), 0.5f));
}

TEST(LightTree, CoincidentLightsAreAllReachable) {
  const LightTree tree = TreeOf(PointBounds(std::vector<Point3>(1000, {1, 1, 1})));
  double total = 0;
  for (int light = 0; light < 1000; ++light) total += static_cast<double>(tree.Pmf(At({}, {}), light));
  EXPECT_NEAR(total, 1, 1e-4);
}

TEST(LightTree, OmitsLightsWithoutStrength) {
  std::vector<LightBounds> bounds = BoundsOf(RandomTriangles(3, 11), true);
  bounds[1].strength = 0;
  const LightTree tree = TreeOf(bounds);
  EXPECT_TRUE(tree.Contains(0));
  EXPECT_FALSE(tree.Contains(1));
  EXPECT_TRUE(LightTree().empty());
  EXPECT_FALSE(LightTree().Choose(At({}, {}), 0.5f));
}

TEST(NormalCones, UnionContainsBoth) {
  TestRandom random(12);
  for (int i = 0; i < 2000; ++i) {
    const NormalCone a{SampleUniformSphere(random.Next2<Point2>()), 2 * random.Next() - 1};
    const NormalCone b{SampleUniformSphere(random.Next2<Point2>()), 2 * random.Next() - 1};
    const NormalCone both = Union(a, b);
    for (const NormalCone& part : {a, b}) {
      for (int j = 0; j < 20; ++j) {  // directions on the rim
        const Frame frame = Frame::FromZ(part.axis);
        const float phi = 2 * kPi * random.Next(), r = SafeSqrt(1 - Sqr(part.cos_angle));
        const Vec3 rim = frame.FromLocal({r * std::cos(phi), r * std::sin(phi), part.cos_angle});
        ASSERT_GE(Dot(rim, both.axis), both.cos_angle - 1e-5f);
      }
    }
  }
}

}  // namespace
}  // namespace tessera
