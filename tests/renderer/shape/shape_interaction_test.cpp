// The local geometry of surfaces: against finite differences, and by its conventions.
#include "renderer/shape/shape_interaction.h"

#include <gtest/gtest.h>

#include <string>

#include "renderer/shape/patch.h"
#include "renderer/shape/quadric.h"
#include "renderer/shape/shading_geometry.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera {
namespace {

// The interaction of the nearest hit; fails the test if there is none.
SurfaceInteraction InteractionOf(const Shape& shape, const Ray& ray) {
  const Geometry geometry{{shape}, {}, {}};
  Hit hit;
  EXPECT_TRUE(BruteForceIntersect(geometry, ray, &hit));
  return MakeInteraction(geometry, hit, ray);
}

void ExpectNear(Vec3 a, Vec3 b, float tolerance, const std::string& what) {
  EXPECT_LT(Distance(a, b), tolerance)
      << what << ": " << a.x << " " << a.y << " " << a.z << " and " << b.x << " " << b.y << " " << b.z;
}

struct InteractionCase {
  std::string name;
  Shape shape;
  Ray ray;
};

std::vector<InteractionCase> SmoothCases() {
  const Transform turn = Translate({1, 2, 3}) * Rotate(50, {1, -2, 0.5f});
  const Transform stretch = turn * Scale(1, 2, 0.7f);
  const Ray ray{{-4, -3, -5}, {5.1f, 4.9f, 8.05f}};
  Shape with_uv = PatchShape({-1, -2, 3}, {4, -2, 3.5f}, {-1, 5, 2}, {4, 5, 4});
  std::get<BilinearMesh>(with_uv.form).uv = {{0, 0}, {2, 0}, {0, 3}, {2, 3}};
  return {{"sphere", QuadricShape(kSphere, turn, 2, -2, 2), ray},
          {"part of an ellipsoid", QuadricShape(kSphere, stretch, 2, -1.9f, 1.9f, 6.28f), ray},
          {"cylinder", QuadricShape(kCylinder, stretch, 1, -5, 5), ray},
          {"disk", QuadricShape(kDisk, stretch, 50, 0.1f, 0, 2 * kPi, 0.01f), ray},
          {"patch", PatchShape({-1, -2, 3}, {4, -2, 3.5f}, {-1, 5, 2}, {4, 5, 4}), ray},
          {"patch with texture coordinates", with_uv, ray}};
}

// p is a function of uv: between two nearby hits it changes by dpdu du + dpdv dv, and the normal likewise.
TEST(ShapeInteraction, DerivativesAreThoseOfFiniteDifferences) {
  for (const InteractionCase& c : SmoothCases()) {
    const SurfaceInteraction a = InteractionOf(c.shape, c.ray);
    for (const Vec3 shift : {Vec3{0.01f, 0, 0}, Vec3{0, 0.01f, 0}, Vec3{0, 0, 0.01f}}) {
      Ray nearby = c.ray;
      nearby.d = nearby.d + shift;
      const SurfaceInteraction b = InteractionOf(c.shape, nearby);
      // The mean of both ends' derivatives: second order.
      const Vec2 duv = b.uv - a.uv;
      const Vec3 dp = ((a.dpdu + b.dpdu) * duv.x + (a.dpdv + b.dpdv) * duv.y) * 0.5f;
      const Vec3 dn =
          ((a.shading.dndu + b.shading.dndu) * duv.x + (a.shading.dndv + b.shading.dndv) * duv.y) * 0.5f;
      ExpectNear(b.p - a.p, dp, 1e-4f, c.name);
      // Of the ellipsoid and the stretched cylinder, pbrt transforms the derivative of the object-space
      // normal.
      const bool is_stretched = c.name == "part of an ellipsoid" || c.name == "cylinder";
      if (!is_stretched) ExpectNear(b.n - a.n, dn, 2e-4f, c.name + ", normal");
    }
  }
}

TEST(ShapeInteraction, TheNormalIsTheCrossProductOfTheDerivatives) {
  for (const InteractionCase& c : SmoothCases()) {
    const SurfaceInteraction at = InteractionOf(c.shape, c.ray);
    const Normal3 n = Normalize(Cross(at.dpdu, at.dpdv));
    ExpectNear(n, at.n, 2e-6f, c.name);
    ExpectNear(at.shading.n, at.n, 2e-6f, c.name);
    ExpectNear(at.wo, Normalize(-c.ray.d), 1e-6f, c.name);
  }
}

TEST(ShapeInteraction, FlippedNormalsPointTheOtherWay) {
  for (InteractionCase& c : SmoothCases()) {
    const Normal3 n = InteractionOf(c.shape, c.ray).n;
    std::visit([](auto& form) { form.flip_normals = !form.flip_normals; }, c.shape.form);
    ExpectNear(InteractionOf(c.shape, c.ray).n, -n, 1e-6f, c.name);
    ExpectNear(InteractionOf(c.shape, c.ray).shading.n, -n, 1e-6f, c.name);
  }
}

TEST(ShapeInteraction, NormalsOfClosedQuadricsPointOutward) {
  const Ray ray{{5, 0.2f, 0.3f}, {-1, 0, 0}};
  EXPECT_GT(InteractionOf(QuadricShape(kSphere, {}), ray).n.x, 0.9f);
  EXPECT_GT(InteractionOf(QuadricShape(kCylinder, {}), ray).n.x, 0.9f);
  EXPECT_GT(InteractionOf(QuadricShape(kDisk, {}), {{0.1f, 0.2f, 5}, {0, 0, -1}}).n.z, 0.9f);
  // A transform that swaps handedness flips them (pbrt: orientation is that of the parametrisation).
  EXPECT_LT(InteractionOf(QuadricShape(kSphere, Scale(-1, 1, 1)), ray).n.x, -0.9f);
}

TEST(ShapeInteraction, AHitAtThePoleOfASphereIsFinite) {
  const SurfaceInteraction at = InteractionOf(SphereShape({0, 0, 0}, 2), {{0, 0, 5}, {0, 0, -1}});
  EXPECT_TRUE(IsFinite(at.dpdu) && IsFinite(at.dpdv) && IsFinite(at.shading.dndu) &&
              IsFinite(at.shading.dndv));
  ExpectNear(at.n, {0, 0, 1}, 1e-5f, "normal");
}

TEST(ShapeInteraction, TrianglesWithoutTextureCoordinatesHaveTheDefaultOnes) {
  // Positions equal to the default (u, v).
  const Shape shape = TriangleShape({0, 0, 0}, {1, 0, 0}, {1, 1, 0});
  const SurfaceInteraction at = InteractionOf(shape, {{0.75f, 0.25f, 1}, {0, 0, -1}});
  EXPECT_NEAR(at.uv.x, 0.75f, 1e-6);
  EXPECT_NEAR(at.uv.y, 0.25f, 1e-6);
  ExpectNear(at.dpdu, {1, 0, 0}, 1e-6f, "dpdu");
  ExpectNear(at.dpdv, {0, 1, 0}, 1e-6f, "dpdv");
  ExpectNear(at.n, {0, 0, 1}, 1e-6f, "n");
}

Shape ShadedTriangle() {
  Shape shape = TriangleShape({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  auto& mesh = std::get<TriangleMesh>(shape.form);
  mesh.uv = {{0, 0}, {2, 0}, {0, 4}};
  mesh.N = {Normalize({0, 0, -1}), Normalize({0.5f, 0, -1}), Normalize({0, 0.5f, -1})};
  return shape;
}

TEST(ShapeInteraction, VertexNormalsDecideTheSideAndAreInterpolated) {
  const Shape shape = ShadedTriangle();
  const SurfaceInteraction at = InteractionOf(shape, {{0.25f, 0.5f, 1}, {0, 0, -1}});
  const auto& N = std::get<TriangleMesh>(shape.form).N;
  ExpectNear(at.n, {0, 0, -1}, 1e-6f, "geometric");
  ExpectNear(at.shading.n, Normalize(N[0] * 0.25f + N[1] * 0.25f + N[2] * 0.5f), 1e-6f, "shading");
  EXPECT_NEAR(Dot(at.shading.n, at.shading.dpdu), 0, 1e-6);
  EXPECT_NEAR(Dot(at.shading.n, at.shading.dpdv), 0, 1e-6);
  ExpectNear(at.shading.dndu, (N[1] - N[0]) * 0.5f, 1e-6f, "dndu");
  ExpectNear(at.shading.dndv, (N[2] - N[0]) * 0.25f, 1e-6f, "dndv");
  ExpectNear(at.dpdu, {0.5f, 0, 0}, 1e-6f, "dpdu");
  ExpectNear(at.dpdv, {0, 0.25f, 0}, 1e-6f, "dpdv");
}

TEST(ShapeInteraction, DerivativesOfTheNormalAreLeftOutWhereTheMaterialDoesNotUseThem) {
  for (const bool is_sphere : {false, true}) {
    Shape shape = is_sphere ? QuadricShape(kSphere, Transform(), 1, -1, 1) : ShadedTriangle();
    const Ray ray{{0.25f, 0.5f, 5}, {0, 0, -1}};
    const SurfaceInteraction with = InteractionOf(shape, ray);
    shape.surface.needs_normal_derivatives = false;
    const SurfaceInteraction without = InteractionOf(shape, ray);
    EXPECT_GT(LengthSquared(with.shading.dndu), 0);
    EXPECT_EQ(without.shading.dndu, Vec3{});
    EXPECT_EQ(without.shading.dndv, Vec3{});
    EXPECT_EQ(without.p, with.p);
    EXPECT_EQ(without.shading.n, with.shading.n);
    EXPECT_EQ(without.shading.dpdu, with.shading.dpdu);
    EXPECT_EQ(without.shading.dpdv, with.shading.dpdv);
  }
}

TEST(ShapeInteraction, TangentsOfTrianglesAreLeftOutWhereTheMaterialDoesNotUseThem) {
  const Ray ray{{0.25f, 0.5f, 5}, {0, 0, -1}};
  for (const bool has_normals : {false, true}) {
    Shape shape = has_normals ? ShadedTriangle() : TriangleShape({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SurfaceInteraction with = InteractionOf(shape, ray);
    shape.surface.needs_tangents = shape.surface.needs_normal_derivatives = false;
    const SurfaceInteraction without = InteractionOf(shape, ray);
    EXPECT_GT(LengthSquared(with.dpdu), 0);
    EXPECT_EQ(without.dpdu, Vec3{});
    EXPECT_EQ(without.shading.dpdu, Vec3{});
    EXPECT_EQ(without.p, with.p);
    EXPECT_EQ(without.p_error, with.p_error);
    EXPECT_EQ(without.uv, with.uv);
    EXPECT_EQ(without.n, with.n);
    EXPECT_EQ(without.shading.n, with.shading.n);
  }
}

TEST(ShapeInteraction, VertexTangentsRotateTheShadingFrame) {
  Shape shape = ShadedTriangle();
  std::get<TriangleMesh>(shape.form).S = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
  const SurfaceInteraction at = InteractionOf(shape, {{0.25f, 0.25f, 1}, {0, 0, -1}});
  EXPECT_GT(Dot(Normalize(at.shading.dpdu), {0, 1, 0}), 0.9f);
  ExpectNear(at.dpdu, {0.5f, 0, 0}, 1e-6f, "dpdu stays that of the texture coordinates");
}

TEST(ShapeInteraction, PatchNormalsAreInterpolatedAndRotateTheShadingFrame) {
  Shape shape = PatchShape({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
  const Normal3 tilted = Normalize({0.5f, 0, 1});
  std::get<BilinearMesh>(shape.form).N = {tilted, tilted, tilted, tilted};
  const SurfaceInteraction at = InteractionOf(shape, {{0.25f, 0.5f, 1}, {0, 0, -1}});
  ExpectNear(at.shading.n, tilted, 1e-6f, "shading normal");
  ExpectNear(at.n, {0, 0, 1}, 1e-6f, "geometric normal");
  ExpectNear(Normalize(Cross(at.shading.dpdu, at.shading.dpdv)), tilted, 1e-5f, "frame");
  ExpectNear(at.shading.dpdv, {0, 1, 0}, 1e-5f, "the axis of the turn stays");
}

TEST(ShapeInteraction, RotationTakesOneDirectionToTheOther) {
  TestRandom random(2);
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = RandomDirection(random);
    const Vec3 to = i % 4 == 0 ? -from : RandomDirection(random);
    const Vec3 v = RandomDirection(random), w = RandomDirection(random);
    ExpectNear(RotateFromTo(from, from, to), to, 1e-4f, "from");
    EXPECT_NEAR(Dot(RotateFromTo(v, from, to), RotateFromTo(w, from, to)), Dot(v, w), 1e-4);
  }
}

TEST(ShapeInteraction, DegenerateTrianglesAndPatchesStayFinite) {
  const Geometry geometry{
      {TriangleShape({1, 1, 1}, {1, 1, 1}, {1, 1, 1}), PatchShape({1, 1, 1}, {1, 1, 1}, {2, 1, 1}, {2, 2, 1}),
       PatchShape({1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1})},
      {},
      {}};
  for (uint32_t i = 0; i < 3; ++i) {
    Hit hit;
    hit.shape = i;
    hit.t = 1;
    const SurfaceInteraction at = MakeInteraction(geometry, hit, {{1, 1, 0}, {0, 0, 1}});
    EXPECT_NEAR(Length(at.n), 1, 1e-5);
    EXPECT_TRUE(IsFinite(at.dpdu) && IsFinite(at.dpdv) && IsFinite(at.shading.n)) << i;
    EXPECT_TRUE(IsFinite(MakeHitPoint(geometry, hit, {{1, 1, 0}, {0, 0, 1}}).n)) << i;
  }
}

TEST(ShapeInteraction, HitPointsAgreeWithInteractions) {
  for (const InteractionCase& c : SmoothCases()) {
    Geometry geometry;
    geometry.groups.push_back({{c.shape}});
    geometry.shapes.push_back(c.shape);
    geometry.instances.push_back({0, Transform()});
    Hit hit;
    ASSERT_TRUE(BruteForceIntersect(geometry, c.ray, &hit));
    for (const uint32_t instance : {Hit::kNoInstance, 0u}) {
      hit.instance = instance;
      const SurfaceInteraction at = MakeInteraction(geometry, hit, c.ray);
      const HitPoint point = MakeHitPoint(geometry, hit, c.ray);
      ExpectNear(point.p, at.p, 1e-5f, c.name);
      ExpectNear(point.n, at.n, 1e-6f, c.name);
      EXPECT_NEAR(point.uv.x, at.uv.x, 1e-6);
      EXPECT_NEAR(point.uv.y, at.uv.y, 1e-6);
    }
  }
}

// A mirrored instance keeps the normals' side: they are only transformed.
TEST(ShapeInteraction, AnInstanceTransformsNormalsWithoutFlippingThem) {
  Geometry geometry;
  geometry.groups.push_back({{SphereShape({0, 0, 0}, 1)}});
  geometry.instances.push_back({0, Translate({5, 0, 0}) * Scale(-2, 1, 1)});
  Hit hit;
  hit.instance = 0;
  hit.t = 3;
  const SurfaceInteraction at = MakeInteraction(geometry, hit, {{0, 0, 0}, {1, 0, 0}});
  ExpectNear(at.p, {3, 0, 0}, 1e-5f, "p");
  ExpectNear(at.n, {-1, 0, 0}, 1e-5f, "n");
}

TEST(ShapeInteraction, InteractionsCarryTheSurfaceProperties) {
  Geometry geometry{{BallMesh(4, {}, 1)}, {}, {}};
  SurfaceProperties& surface = geometry.shapes[0].surface;
  surface.material = 3;
  surface.area_light = 10;
  surface.inside_medium = 1;
  Hit hit;
  hit.primitive = 7;
  const SurfaceInteraction at = MakeInteraction(geometry, hit, {{0, 0, 0}, {1, 0, 0}, INFINITY, 0.25f});
  EXPECT_EQ(at.material, 3);
  EXPECT_EQ(at.area_light, 17);
  EXPECT_EQ(at.inside_medium, 1);
  EXPECT_EQ(at.outside_medium, -1);
  EXPECT_EQ(at.time, 0.25f);
  surface.area_light = -1;
  EXPECT_EQ(MakeInteraction(geometry, hit, {{0, 0, 0}, {1, 0, 0}}).area_light, -1);
}

TEST(Geometry, CountsAndBoundsIncludeInstances) {
  Geometry geometry{{TriangleShape({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}, {}, {}};
  geometry.groups.push_back({{BallMesh(4, {}, 1), SphereShape({}, 1)}});
  geometry.instances.push_back({0, Translate({10, 0, 0})});
  geometry.instances.push_back({0, Translate({0, 20, 0})});
  EXPECT_EQ(geometry.PrimitiveCount(), 1 + geometry.groups[0].shapes[0].PrimitiveCount() + 1);
  const Bounds3 bounds = geometry.Bounds();
  EXPECT_NEAR(bounds.max.x, 11, 1e-4);
  EXPECT_NEAR(bounds.max.y, 21, 1e-4);
  EXPECT_NEAR(bounds.min.z, -1, 1e-4);
  EXPECT_EQ(&ShapeOf(geometry, Hit::kNoInstance, 0), &geometry.shapes[0]);
  EXPECT_EQ(&ShapeOf(geometry, 1, 1), &geometry.groups[0].shapes[1]);
}

}  // namespace
}  // namespace tessera
