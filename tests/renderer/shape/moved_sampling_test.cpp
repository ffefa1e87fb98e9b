#include "renderer/shape/moved_sampling.h"

#include <gtest/gtest.h>

#include "renderer/math/sampling.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera::moved_sampling {
namespace {

struct MovedCase {
  const char* name;
  Shape shape;         // in its own space
  Shape in_rendering;  // the same after `transform`
  Transform transform;
};

std::vector<MovedCase> MovedCases() {
  const Point3 a{-1, -0.5f, 0}, b{1, -0.7f, 0.2f}, c{0.1f, 1, -0.2f};
  const Transform stretched =
      Translate({1, 2, 5}) * Rotate(50, {1, 2, 3}) * Scale(2, 0.5f, 1) * Rotate(20, {0, 1, 1});
  const Transform mirrored = Translate({-2, 1, 4}) * Scale(-1.5f, 1.5f, 1.5f);
  const auto to_rendering = [](const Transform& t, Point3 p) { return t.ToPoint(p); };
  std::vector<MovedCase> cases;
  for (const Transform& t : {stretched, mirrored}) {
    cases.push_back({"triangle", TriangleShape(a, b, c),
                     TriangleShape(to_rendering(t, a), to_rendering(t, b), to_rendering(t, c)), t});
  }
  const Transform even = Translate({1, 0, 6}) * Rotate(70, {1, 1, 0}) * Scale(2, 2, 2);
  cases.push_back({"sphere", SphereShape({0, 0, 0}, 0.8f), SphereShape(even.ToPoint({0, 0, 0}), 1.6f), even});
  return cases;
}

const ReferencePoint kReference{{0.2f, -0.3f, 0.5f}, {}, {0, 0, 1}, {0, 0, 1}, 0.5f};

// The solid angle of the shape and the mean of a function of direction over it.
TEST(MovedSampling, IntegratesOverDirectionsAsIfTheShapeWereInRenderingSpace) {
  constexpr int kSamples = 40000;
  for (const MovedCase& moved : MovedCases()) {
    double there[2] = {0, 0}, here[2] = {0, 0};
    const auto add = [](const std::optional<ShapeSample>& sample, double(&sums)[2]) {
      if (!sample || !(sample->pdf > 0)) return;
      const Vec3 wi = Normalize(sample->p - kReference.p);
      sums[0] += 1 / static_cast<double>(sample->pdf);
      sums[1] += static_cast<double>(wi.x * wi.x + wi.z) / static_cast<double>(sample->pdf);
    };
    TestRandom random(3);
    for (int i = 0; i < kSamples; ++i) {
      const Point2 u = Random2(random);
      add(SampleMovedShape(moved.shape, 0, moved.transform, kReference, u), there);
      add(SampleShape(moved.in_rendering, 0, kReference, u), here);
    }
    ASSERT_GT(here[0], 0) << moved.name;
    EXPECT_NEAR(there[0] / here[0], 1, 0.01) << moved.name;
    EXPECT_NEAR(there[1] / here[1], 1, 0.01) << moved.name;
  }
}

TEST(MovedSampling, TheDensityOfASampleIsThatOfItsPoint) {
  for (const MovedCase& moved : MovedCases()) {
    TestRandom random(4);
    for (int i = 0; i < 1000; ++i) {
      const auto sample = SampleMovedShape(moved.shape, 0, moved.transform, kReference, Random2(random));
      ASSERT_TRUE(sample) << moved.name;
      SurfaceInteraction on_light;
      on_light.p = sample->p;
      on_light.n = sample->n;
      on_light.uv = sample->uv;
      const Vec3 wi = Normalize(sample->p - kReference.p);
      const float pdf = MovedShapePdf(moved.shape, 0, moved.transform, kReference, wi, on_light);
      ASSERT_NEAR(pdf, sample->pdf, 0.01f * sample->pdf) << moved.name;
      ASSERT_NEAR(Length(sample->n), 1, 1e-5f);
    }
  }
}

TEST(MovedSampling, TheFarSideOfASphereHasNoDensity) {
  for (const float mirror : {1.f, -1.f}) {
    const Transform even = Translate({1, 0, 6}) * Rotate(70, {1, 1, 0}) * Scale(2 * mirror, 2, 2);
    for (const bool is_flipped : {false, true}) {
      Shape sphere = SphereShape({0, 0, 0}, 0.8f);
      std::get<Quadric>(sphere.form).flip_normals = is_flipped;
      const Vec3 to_center = even.ToPoint({0, 0, 0}) - kReference.p, wi = Normalize(to_center);
      const float distance = Length(to_center), radius = 1.6f;
      const auto density_at = [&](float along, Normal3 outward) {
        SurfaceInteraction on_light;
        on_light.p = kReference.p + wi * along;
        on_light.n = is_flipped ? -outward : outward;
        return MovedShapePdf(sphere, 0, even, kReference, wi, on_light);
      };
      const float cone = 2 * kPi * (1 - std::sqrt(1 - Sqr(radius / distance)));
      EXPECT_NEAR(density_at(distance - radius, -wi) * cone, 1, 1e-3f);
      EXPECT_EQ(density_at(distance + radius, wi), 0);
    }
  }
}

TEST(MovedSampling, AreasAreThoseInRenderingSpace) {
  for (const MovedCase& moved : MovedCases()) {
    const auto area = MovedShapeArea(moved.shape, 0, moved.transform);
    ASSERT_TRUE(area) << moved.name;
    EXPECT_NEAR(*area, ShapeArea(moved.in_rendering, 0), 1e-3f * *area) << moved.name;
  }
  EXPECT_FALSE(MovedShapeArea(SphereShape({0, 0, 0}, 1), 0, Scale(1, 2, 1)));
  EXPECT_FALSE(MovedShapeArea(SphereShape({0, 0, 0}, 1), 0,
                              Rotate(45, {0, 0, 1}) * Scale(1, 2, 1) * Rotate(-45, {0, 0, 1})));
}

TEST(MovedSampling, ANormalKeepsItsSideUnderAMirrorImage) {
  const Shape triangle = TriangleShape({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  const Transform mirrored = Translate({0, 0, 3}) * Scale(1, 1, -1);
  const auto sample = SampleMovedShape(triangle, 0, mirrored, kReference, {0.3f, 0.4f});
  const auto still = SampleShape(triangle, 0, {{0, 0, -3}, {}, {}, {}}, {0.3f, 0.4f});
  ASSERT_TRUE(sample && still);
  EXPECT_FLOAT_EQ(sample->n.z, -still->n.z);
}

}  // namespace
}  // namespace tessera::moved_sampling
