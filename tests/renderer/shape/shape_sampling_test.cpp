// Every shape's sampling against its own density, and both against the geometry.
#include "renderer/shape/shape_sampling.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/renderer/shape/example_shapes.h"

namespace tessera {
namespace {

struct SamplingCase {
  std::string name;
  Shape shape;
  ReferencePoint reference;
};

ReferencePoint InVolume(Point3 p) {
  return {p, {}, {}, {}};
}
ReferencePoint OnSurface(Point3 p, Normal3 n) {
  return {p, {}, Normalize(n), Normalize(n)};
}

std::vector<SamplingCase> Cases() {
  const Shape triangle = TriangleShape({1, 0.2f, 0.3f}, {-0.5f, 1, 0.6f}, {-0.2f, -0.9f, 1});
  const Shape tiny = TriangleShape({0.01f, 0, 3}, {0, 0.02f, 3}, {-0.01f, 0, 3.01f});
  const Shape rectangle = PatchShape({-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1});
  const Shape off_side = PatchShape({0.2f, 0.1f, 0.7f}, {2, 0.1f, 0.7f}, {0.2f, 3, 0.7f}, {2, 3, 0.7f});
  const Shape trapezoid = PatchShape({-1, -1, 1}, {1, -1, 1}, {-0.3f, 1, 1.2f}, {0.4f, 1, 1.2f});
  const Shape twisted = PatchShape({-1, -1, 1}, {1, -1, 2}, {-1, 1, 2}, {1, 1, 0.8f});
  Shape flipped = SphereShape({0.5f, 0.2f, 2}, 1);
  std::get<Quadric>(flipped.form).flip_normals = true;
  const Transform turn = Translate({0.3f, -0.2f, 2}) * Rotate(40, {1, 2, 3});
  const Transform stretch = turn * Scale(1, 0.5f, 1.5f);
  const Point3 origin{0, 0, 0};
  // From outside, the density of what is sampled by area has poles at the silhouette, where
  // quadrature fails.
  const Point3 inside{0.35f, -0.1f, 2.1f};
  const Normal3 tilted{0.3f, -0.5f, 0.8f};
  return {
      {"triangle, in a volume", triangle, InVolume(origin)},
      {"triangle, on a surface", triangle, OnSurface(origin, tilted)},
      {"triangle seen edge on", triangle, OnSurface({0.4f, 0.3f, -0.2f}, {1, 0, 0.1f})},
      {"tiny triangle", tiny, OnSurface(origin, tilted)},
      {"rectangle, in a volume", rectangle, InVolume(origin)},
      {"rectangle, on a surface", rectangle, OnSurface({0.5f, -0.3f, 0.1f}, tilted)},
      {"rectangle off to the side", off_side, OnSurface({-0.3f, -0.2f, 0.1f}, tilted)},
      {"rectangle seen from behind", off_side, InVolume({0.5f, 0.8f, 2})},
      {"trapezoid", trapezoid, OnSurface(origin, tilted)},
      {"twisted patch", twisted, InVolume(origin)},
      {"sphere from outside", SphereShape({0.5f, 0.2f, 2}, 1), InVolume(origin)},
      {"sphere from inside", SphereShape({0.2f, 0.1f, 0.3f}, 1), InVolume(origin)},
      {"far sphere", SphereShape({0.5f, 0.2f, 100}, 1), InVolume(origin)},
      {"scaled and turned sphere", QuadricShape(kSphere, turn * Scale(0.5f, 0.5f, 0.5f)), InVolume(origin)},
      {"sphere with normals that point inward", flipped, InVolume(origin)},
      {"mirrored sphere", QuadricShape(kSphere, turn * Scale(-0.5f, 0.5f, 0.5f)), InVolume(origin)},
      {"ellipsoid", QuadricShape(kSphere, stretch), InVolume(origin)},
      {"part of a sphere", QuadricShape(kSphere, turn, 1, -0.5f, 0.7f, 4), InVolume(inside)},
      {"cylinder", QuadricShape(kCylinder, turn, 0.5f, -1, 0.5f), InVolume(inside)},
      {"part of an elliptic cylinder", QuadricShape(kCylinder, stretch, 0.5f, -1, 0.5f, 5), InVolume(inside)},
      {"disk", QuadricShape(kDisk, turn, 1, 0.2f), InVolume(origin)},
      {"part of a ring, stretched", QuadricShape(kDisk, stretch, 1, 0.2f, 0, 5, 0.3f), InVolume(origin)}};
}

// The density of a direction by ShapePdf: the sum over all points where the direction meets the shape.
float PdfOfDirection(const SamplingCase& c, Vec3 wi) {
  const Geometry geometry{{c.shape}, {}, {}};
  const Ray ray{c.reference.p, wi};
  float pdf = 0;
  double t_min = 0;
  for (int i = 0; i < 3; ++i) {
    const Hit hit = IntersectPrimitive(c.shape, 0, {Double3(ray.o), Double3(ray.d)}, t_min);
    if (hit.t < 0) break;
    pdf += ShapePdf(c.shape, 0, c.reference, wi, MakeInteraction(geometry, hit, ray));
    t_min = hit.t * (1 + 1e-6);
  }
  return pdf;
}

// Whole spheres are sampled on their near side only.
bool IsConeSampled(const SamplingCase& c) {
  return c.name.find("sphere") != std::string::npos && c.name[0] != 'p';
}
bool IsSmall(const SamplingCase& c) {
  return c.name == "far sphere" || c.name == "tiny triangle";
}

TEST(ShapeSampling, PointsDoNotDependOnWhetherTheirTextureCoordinatesAreNeeded) {
  TestRandom random(3);
  for (const SamplingCase& c : Cases()) {
    for (int i = 0; i < 100; ++i) {
      const Point2 u = Random2(random);
      const auto with = SampleShape(c.shape, 0, c.reference, u, true);
      const auto without = SampleShape(c.shape, 0, c.reference, u, false);
      ASSERT_EQ(with.has_value(), without.has_value()) << c.name;
      if (!with) continue;
      EXPECT_EQ(with->p, without->p) << c.name;
      EXPECT_EQ(with->n, without->n) << c.name;
      EXPECT_EQ(with->pdf, without->pdf) << c.name;
    }
  }
}

TEST(ShapeSampling, DirectionsFollowTheDensityOfEveryShape) {
  int test_count = 0;
  const std::vector<SamplingCase> cases = Cases();
  for (const SamplingCase& c : cases) {
    if (IsSmall(c)) continue;
    TestRandom random(++test_count);
    const ChiSquareResult result = ChiSquareSphere<Vec3>(
        [&]() -> std::optional<Vec3> {
          const auto sample = SampleShape(c.shape, 0, c.reference, Random2(random));
          if (!sample) return std::nullopt;
          return Normalize(sample->p - c.reference.p);
        },
        [&](Vec3 wi) { return PdfOfDirection(c, wi); }, 14, 16, 50000);
    EXPECT_TRUE(result.Passes(static_cast<int>(cases.size()))) << c.name << ": " << result.text;
    EXPECT_NEAR(result.pdf_total, 1, 0.01) << c.name;
  }
}

TEST(ShapeSampling, TheDensityOfASampleIsTheDensityOfItsDirection) {
  for (const SamplingCase& c : Cases()) {
    TestRandom random(7);
    int count = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto sample = SampleShape(c.shape, 0, c.reference, Random2(random));
      if (!sample) continue;
      ++count;
      SurfaceInteraction on_light;
      on_light.p = sample->p;
      on_light.n = sample->n;
      on_light.uv = sample->uv;
      const float pdf = ShapePdf(c.shape, 0, c.reference, Normalize(sample->p - c.reference.p), on_light);
      ASSERT_NEAR(pdf / sample->pdf, 1, 2e-3) << c.name;
    }
    EXPECT_GT(count, 1900) << c.name;
  }
}

// The solid angle of the shape by the midpoint rule over its area, both sides of closed shapes counted.
double SolidAngleByArea(const SamplingCase& c) {
  constexpr int kSteps = 400;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const float u = (i + 0.5f) / kSteps, v = (j + 0.5f) / kSteps;
      Double3 p, by_u, by_v;
      if (const auto* mesh = std::get_if<TriangleMesh>(&c.shape.form)) {
        const auto t = mesh->At(0);  // (u, v (1 - u)) covers it
        const Double3 e1 = Difference(t.p1, t.p0), e2 = Difference(t.p2, t.p0);
        p = Double3(t.p0) + e1 * u + e2 * (v * (1 - u));
        by_u = e1 + e2 * -v;
        by_v = e2 * (1 - u);
      } else if (const auto* patches = std::get_if<BilinearMesh>(&c.shape.form)) {
        const auto patch = patches->At(0);
        p = Double3(PatchPoint(patch, {u, v}));
        const PatchDerivatives d = DifferentiatePatch(patch, {u, v});
        by_u = Double3(d.dpdu);
        by_v = Double3(d.dpdv);
      } else {
        const Quadric& q = std::get<Quadric>(c.shape.form);
        const float phi = u * q.phi_max, z = q.z_min + v * (q.z_max - q.z_min);
        const float r = q.kind == kSphere ? std::sqrt(q.radius * q.radius - z * z)
                        : q.kind == kDisk ? q.inner_radius + v * (q.radius - q.inner_radius)
                                          : q.radius;
        const Point3 object{r * std::cos(phi), r * std::sin(phi), z};
        const float slope = q.kind == kSphere ? -z / r : 0;
        const Vec3 dv = q.kind == kDisk
                            ? Vec3{std::cos(phi), std::sin(phi), 0} * (q.radius - q.inner_radius)
                            : Vec3{slope * std::cos(phi), slope * std::sin(phi), 1} * (q.z_max - q.z_min);
        p = Double3(q.render_from_object.ToPoint(object));
        by_u = Double3(q.render_from_object.ToVector(Vec3{-object.y, object.x, 0} * q.phi_max));
        by_v = Double3(q.render_from_object.ToVector(dv));
      }
      const Double3 d = p - Double3(c.reference.p);
      const double distance = std::sqrt(Dot(d, d));
      sum += std::abs(Dot(Cross(by_u, by_v), d)) / (distance * distance * distance);
    }
  }
  return sum / (kSteps * kSteps);
}

TEST(ShapeSampling, TheMeanOfOneOverTheDensityIsTheSolidAngle) {
  for (const SamplingCase& c : Cases()) {
    TestRandom random(11);
    constexpr int kSamples = 100000;
    double sum = 0, sum_squares = 0;
    for (int i = 0; i < kSamples; ++i) {
      const auto sample = SampleShape(c.shape, 0, c.reference, Random2(random));
      const double value = sample ? 1.0 / sample->pdf : 0;
      sum += value;
      sum_squares += value * value;
    }
    const double mean = sum / kSamples;
    const double deviation = std::sqrt(std::max(0.0, sum_squares / kSamples - mean * mean) / kSamples);
    const bool counts_once = IsConeSampled(c) && c.name != "sphere from inside";
    const double expected = SolidAngleByArea(c) / (counts_once ? 2 : 1);
    EXPECT_NEAR(mean, expected, 4 * deviation + 2e-3 * expected) << c.name;
  }
}

TEST(ShapeSampling, SampledPointsLieOnTheShapeWithItsNormal) {
  for (const SamplingCase& c : Cases()) {
    const Geometry geometry{{c.shape}, {}, {}};
    TestRandom random(3);
    for (int i = 0; i < 500; ++i) {
      const auto sample = SampleShape(c.shape, 0, c.reference, Random2(random));
      if (!sample) continue;
      // Seen from a point straight above the sample.
      const Ray ray{sample->p + sample->n * 0.01f, -sample->n};
      const Hit hit = IntersectPrimitive(c.shape, 0, {Double3(ray.o), Double3(ray.d)}, 0);
      if (hit.t < 0) continue;  // at the very edge
      const SurfaceInteraction found = MakeInteraction(geometry, hit, ray);
      const float scale = 1e-5f * (1 + Length(sample->p));
      EXPECT_LT(Distance(found.p, sample->p), scale) << c.name;
      EXPECT_GT(Dot(found.n, sample->n), 0.9999f) << c.name;
      EXPECT_LT(std::abs(found.uv.x - sample->uv.x) + std::abs(found.uv.y - sample->uv.y), 2e-3f) << c.name;
    }
  }
}

TEST(ShapeSampling, AreasAreThoseOfTheGeometry) {
  const Transform turn = Rotate(30, {1, 1, 0});
  EXPECT_NEAR(ShapeArea(TriangleShape({0, 0, 0}, {2, 0, 0}, {0, 3, 0}), 0), 3, 1e-6);
  EXPECT_NEAR(ShapeArea(PatchShape({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {2, 3, 0}), 0), 6, 1e-5);
  EXPECT_NEAR(ShapeArea(PatchShape({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {1, 3, 0}), 0), 4.5f, 1e-3);
  EXPECT_NEAR(ShapeArea(SphereShape({5, 0, 0}, 2), 0), 16 * kPi, 1e-3);
  EXPECT_NEAR(ShapeArea(QuadricShape(kSphere, turn * Scale(3, 3, 3)), 0), 36 * kPi, 1e-3);
  EXPECT_NEAR(ShapeArea(QuadricShape(kCylinder, turn, 2, 0, 3, kPi), 0), 6 * kPi, 1e-3);
  EXPECT_NEAR(ShapeArea(QuadricShape(kDisk, turn, 2, 0, 0, 2 * kPi, 1), 0), 3 * kPi, 1e-4);
  EXPECT_NEAR(ShapeArea(QuadricShape(kDisk, turn * Scale(2, 3, 4), 1), 0), 6 * kPi, 1e-3);
  // A prolate spheroid with half axes 1, 1, 2: 2 pi (1 + 2/e asin(e)), e = sqrt(3)/2.
  EXPECT_NEAR(ShapeArea(QuadricShape(kSphere, turn * Scale(1, 1, 2)), 0), 21.4784, 0.05);
}

TEST(ShapeSampling, NormalConesHoldEveryNormal) {
  TestRandom random(5);
  for (int i = 0; i < 200; ++i) {
    const Point3 a = RandomPoint(random, 1), b = RandomPoint(random, 1), c = RandomPoint(random, 1);
    Shape patch = PatchShape(a, b, c, b + (c - a) + RandomPoint(random, 0.3f));
    std::get<BilinearMesh>(patch.form).flip_normals = i % 2 == 1;
    const NormalCone cone = ShapeNormals(patch, 0);
    const auto& mesh = std::get<BilinearMesh>(patch.form);
    for (int j = 0; j < 20; ++j) {
      const Normal3 n = mesh.Normal(0, mesh.At(0), Random2(random));
      EXPECT_GE(Dot(n, cone.axis), cone.cos_angle - 1e-3f);
    }
  }
  Shape disk = QuadricShape(kDisk, Scale(1, 1, -1));
  EXPECT_EQ(ShapeNormals(disk, 0).cos_angle, 1);
}

// As seen from a rounding error above itself, it would appear to fill half of all directions.
TEST(ShapeSampling, ARectangleIsNotSampledFromItsOwnPlane) {
  const Shape shape =
      PatchShape({1.75f, 0.25f, -2.6f}, {1.75f, 3.9f, -2.6f}, {3.35f, 0.25f, 0.2f}, {3.35f, 3.9f, 0.2f});
  TestRandom random(1);
  for (int i = 0; i < 1000; ++i) {
    const Point2 uv = Random2(random);
    const BilinearMesh& mesh = std::get<BilinearMesh>(shape.form);
    SurfaceInteraction here;
    Hit hit;
    hit.u = uv.x;
    hit.v = uv.y;
    mesh.FillInteraction(hit, {Ray{}}, &here);
    const ReferencePoint reference{here.p, here.p_error, here.n, here.n};
    EXPECT_FALSE(SampleShape(shape, 0, reference, Random2(random)));
    EXPECT_EQ(ShapePdf(shape, 0, reference, here.n, here), 0);
  }
}

TEST(ShapeSampling, AShapeWithoutAreaIsNeverSampled) {
  const ReferencePoint reference = InVolume({0, 0, 0});
  EXPECT_FALSE(SampleShape(TriangleShape({1, 0, 1}, {2, 0, 1}, {3, 0, 1}), 0, reference, {0.5f, 0.5f}));
  EXPECT_FALSE(
      SampleShape(PatchShape({1, 0, 1}, {1, 0, 1}, {1, 0, 1}, {1, 0, 1}), 0, reference, {0.5f, 0.5f}));
  EXPECT_FALSE(
      SampleShape(QuadricShape(kCylinder, Translate({0, 0, 3}), 1, 0, 0), 0, reference, {0.5f, 0.5f}));
}

}  // namespace
}  // namespace tessera
