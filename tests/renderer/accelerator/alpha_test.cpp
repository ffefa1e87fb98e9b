// Layers of partly transparent surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/accelerator/accelerator.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera::stacked_alpha {
namespace {

constexpr FloatInput kHalf{0.5f, -1};
constexpr const char* kAccelerators[] = {"embree", "bvh", "list"};

// Cards that every ray of `Passing` meets, at z = 1, 2, ...
Geometry Cards(int count, bool are_patches) {
  Geometry geometry;
  for (int i = 1; i <= count; ++i) {
    const auto z = static_cast<float>(i);
    geometry.shapes.push_back(are_patches ? PatchShape({-9, -9, z}, {9, -9, z}, {-9, 9, z}, {9, 9, z + 0.2f})
                                          : TriangleShape({-30, -30, z}, {30, -30, z}, {0, 30, z}));
    geometry.shapes.back().surface.alpha = kHalf;
  }
  return geometry;
}

struct Passed {
  double share = 0;
  std::vector<bool> rays;
};

// The rays along +z, each slightly different, that nothing stops. Checks that each answer is repeated.
Passed Passing(const Geometry& geometry, const char* accelerator_name, int rays) {
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(accelerator_name), geometry, textures);
  TestRandom random(3);
  Passed passed;
  for (int i = 0; i < rays; ++i) {
    const Point2 u = random.Next2<Point2>();
    const Ray ray{{u.x - 0.5f, u.y - 0.5f, 0}, {0, 0, 1}};
    Hit hit;
    passed.rays.push_back(!accelerator->Intersect(ray, &hit));
    EXPECT_EQ(passed.rays.back(), !accelerator->Intersect(ray, &hit));
    EXPECT_EQ(passed.rays.back(), !accelerator->Occluded(ray));
    passed.share += passed.rays.back();
  }
  passed.share /= rays;
  return passed;
}

double Deviation(double share, int rays) {
  return std::sqrt(share * (1 - share) / rays);
}

TEST(StackedAlpha, EachLayerLetsItsShareThrough) {
  constexpr int kRays = 20000;
  for (const bool are_patches : {false, true}) {
    for (int count = 1; count <= 4; ++count) {
      const double expected = std::pow(0.5, count);
      const Geometry cards = Cards(count, are_patches);
      const Passed embree = Passing(cards, "embree", kRays);
      EXPECT_NEAR(embree.share, expected, 4 * Deviation(expected, kRays)) << count << " cards";
      for (const char* other : {"bvh", "list"}) EXPECT_EQ(Passing(cards, other, kRays).rays, embree.rays);
    }
  }
}

TEST(StackedAlpha, PrimitivesOfOneMeshAreLayersToo) {
  constexpr int kRays = 20000;
  TriangleMesh mesh;
  mesh.P = {{-30, -30, 1}, {30, -30, 1}, {0, 30, 1}, {-30, -30, 2}, {30, -30, 2}, {0, 30, 2}};
  mesh.indices = {0, 1, 2, 3, 4, 5};
  Geometry geometry;
  geometry.shapes.push_back({{}, mesh});
  geometry.shapes[0].surface.alpha = kHalf;
  const Passed embree = Passing(geometry, "embree", kRays);
  EXPECT_NEAR(embree.share, 0.25, 4 * Deviation(0.25, kRays));
  for (const char* other : {"bvh", "list"}) EXPECT_EQ(Passing(geometry, other, kRays).rays, embree.rays);
}

TEST(StackedAlpha, InstancesOfOneObjectAreLayersToo) {
  constexpr int kRays = 20000;
  Geometry geometry;
  geometry.groups.push_back({Cards(2, false).shapes});
  for (const float z : {0.0f, 5.0f}) geometry.instances.push_back({0, Translate({0, 0, z})});
  const Passed embree = Passing(geometry, "embree", kRays);
  EXPECT_NEAR(embree.share, 0.0625, 4 * Deviation(0.0625, kRays));
  for (const char* other : {"bvh", "list"}) EXPECT_EQ(Passing(geometry, other, kRays).rays, embree.rays);
}

TEST(StackedAlpha, BothWallsOfASphereAreLayers) {
  constexpr int kRays = 20000;
  Geometry geometry;
  geometry.shapes.push_back(SphereShape({0, 0, 5}, 2));
  geometry.shapes[0].surface.alpha = kHalf;
  const TextureTable textures;
  const Passed expected = Passing(geometry, "embree", kRays);
  EXPECT_NEAR(expected.share, 0.25, 4 * Deviation(0.25, kRays));
  for (const char* name : kAccelerators) {
    EXPECT_EQ(Passing(geometry, name, kRays).rays, expected.rays);
    // Half of the rays stop at the front, a quarter at the back.
    const auto accelerator = *MakeAccelerator(*Accelerators().Find(name), geometry, textures);
    TestRandom random(4);
    int front = 0, back = 0;
    for (int i = 0; i < kRays; ++i) {
      const Point2 u = random.Next2<Point2>();
      Hit hit;
      if (!accelerator->Intersect({{u.x - 0.5f, u.y - 0.5f, 0}, {0, 0, 1}}, &hit)) continue;
      ++(hit.t < 5 ? front : back);
    }
    EXPECT_NEAR(front / double{kRays}, 0.5, 4 * Deviation(0.5, kRays)) << name;
    EXPECT_NEAR(back / double{kRays}, 0.25, 4 * Deviation(0.25, kRays)) << name;
  }
}

}  // namespace
}  // namespace tessera::stacked_alpha
