// Rays that graze a sphere, start inside it or come from far away, for every accelerator.
#include <gtest/gtest.h>

#include "renderer/accelerator/accelerator.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera {
namespace {

class Sphere : public testing::TestWithParam<std::string_view> {};

TEST_P(Sphere, IsSeenFromInsideAndAtItsVeryEdge) {
  const Geometry geometry{{SphereShape({0, 0, 5}, 1)}, {}, {}};
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  Hit hit;
  ASSERT_TRUE(accelerator->Intersect({{0, 0, 5}, {0, 0, 2}}, &hit));
  EXPECT_FLOAT_EQ(hit.t, 0.5f);
  EXPECT_TRUE(accelerator->Intersect({{0.999999f, 0, 0}, {0, 0, 1}}, &hit));
  EXPECT_FALSE(accelerator->Intersect({{1.000001f, 0, 0}, {0, 0, 1}}, &hit));
  ASSERT_TRUE(accelerator->Intersect({{0, 0, -1e6f}, {0, 0, 1}}, &hit));
  EXPECT_NEAR(hit.t, 1e6f + 4, 0.1f);
}

// The distance at which a ray passes the centre decides whether it hits, except for the rounding of the
// sphere's own transformation.
TEST_P(Sphere, IsHitExactlyByRaysThatPassNearerThanItsRadius) {
  const Point3 center{7, -3, 2};
  const double radius = 1.5f;
  const Geometry geometry{{SphereShape(center, 1.5f)}, {}, {}};
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  TestRandom random(21);
  int hits = 0, misses = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3 direction = RandomDirection(random);
    const Vec3 aside = Normalize(Cross(direction, RandomDirection(random)));
    const float offset = std::exp(-14 * random.Next());  // down to a millionth of the radius
    const Point3 edge = center + aside * (1.5f * (i % 2 == 0 ? 1 - offset : 1 + offset));
    const float distance = i % 3 == 0 ? 1000.0f : 5.0f;
    const Ray ray{edge - direction * distance, direction};
    const Double3 to_center = Double3(center) - Double3(ray.o), d(ray.d);
    const double along = Dot(to_center, d) / Dot(d, d);
    const Double3 nearest = to_center - d * along;
    const double passes_at = std::sqrt(Dot(nearest, nearest));
    if (std::abs(passes_at - radius) < 1e-9 * distance) continue;
    Hit hit;
    ASSERT_EQ(accelerator->Intersect(ray, &hit), passes_at < radius) << i << ": " << passes_at;
    ASSERT_EQ(accelerator->Occluded(ray), passes_at < radius) << i;
    ++(passes_at < radius ? hits : misses);
  }
  EXPECT_GT(hits, 50000);
  EXPECT_GT(misses, 50000);
}

TEST_P(Sphere, IsAlwaysLeftFromInside) {
  const Geometry geometry{{SphereShape({100, 20, -5}, 2)}, {}, {}};
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  TestRandom random(22);
  for (int i = 0; i < 100000; ++i) {
    // From the centre to just below the surface, where floats are 8e-6 apart.
    const float depth = 1e-4f + 2 * random.Next() * random.Next();
    const Ray ray{Point3{100, 20, -5} + RandomDirection(random) * std::max(0.0f, 2 - depth),
                  RandomDirection(random)};
    Hit hit;
    ASSERT_TRUE(accelerator->Intersect(ray, &hit)) << i;
    ASSERT_NEAR(Distance(ray.At(hit.t), Point3{100, 20, -5}), 2, 5e-5) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Sphere, testing::ValuesIn(Accelerators().Names()));

}  // namespace
}  // namespace tessera
