#include <gtest/gtest.h>

#include "renderer/texture/texture_mapping.h"

namespace tessera {
namespace {

TextureMapping OfKind(TextureMapping::Kind kind) {
  TextureMapping mapping;
  mapping.kind = kind;
  return mapping;
}

TextureContext ContextAt(Point3 p) {
  TextureContext context;
  context.p = p;
  context.dpdx = {0.02f, 0.01f, -0.03f};
  context.dpdy = {-0.01f, 0.03f, 0.02f};
  return context;
}

TEST(TextureMapping, UvScalesThenShifts) {
  TextureMapping mapping;
  mapping.scale = {2, 3};
  mapping.offset = {0.25f, -1};
  TextureContext context;
  context.uv = {0.5f, 0.25f};
  context.dudx = 0.1f;
  context.dudy = 0.2f;
  context.dvdx = 0.3f;
  context.dvdy = 0.4f;
  const TextureCoordinates2 c = mapping.Map2(context);
  EXPECT_FLOAT_EQ(c.st.x, 1.25f);
  EXPECT_FLOAT_EQ(c.st.y, -0.25f);
  EXPECT_FLOAT_EQ(c.dx.x, 0.2f);
  EXPECT_FLOAT_EQ(c.dx.y, 0.9f);
  EXPECT_FLOAT_EQ(c.dy.x, 0.4f);
  EXPECT_FLOAT_EQ(c.dy.y, 1.2f);
}

TEST(TextureMapping, SphericalGivesTheAnglesFromTheZAxisAndAroundIt) {
  const TextureMapping mapping = OfKind(TextureMapping::Kind::kSpherical);
  const auto st = [&](Point3 p) { return mapping.Map2(ContextAt(p)).st; };
  EXPECT_NEAR(st({0, 0, 5}).x, 0, 1e-6f);
  EXPECT_NEAR(st({0, 0, -5}).x, 1, 1e-6f);
  EXPECT_NEAR(st({2, 0, 0}).x, 0.5f, 1e-6f);
  EXPECT_NEAR(st({2, 0, 0}).y, 0, 1e-6f);
  EXPECT_NEAR(st({0, 2, 0}).y, 0.25f, 1e-6f);
  EXPECT_NEAR(st({0, -2, 0}).y, 0.75f, 1e-6f);
}

TEST(TextureMapping, CylindricalGivesTheAngleFromMinusXAndTheHeight) {
  const TextureMapping mapping = OfKind(TextureMapping::Kind::kCylindrical);
  const auto st = [&](Point3 p) { return mapping.Map2(ContextAt(p)).st; };
  EXPECT_NEAR(st({1, 0, 7}).x, 0.5f, 1e-6f);
  EXPECT_NEAR(st({0, 3, 7}).x, 0.75f, 1e-6f);
  EXPECT_EQ(st({0, 3, 7}).y, 7);
}

TEST(TextureMapping, PlanarProjectsOnTwoAxes) {
  TextureMapping mapping = OfKind(TextureMapping::Kind::kPlanar);
  mapping.s_axis = {1, 1, 0};
  mapping.t_axis = {0, 0, 2};
  mapping.offset = {10, 20};
  const TextureCoordinates2 c = mapping.Map2(ContextAt({1, 2, 3}));
  EXPECT_FLOAT_EQ(c.st.x, 13);
  EXPECT_FLOAT_EQ(c.st.y, 26);
  EXPECT_FLOAT_EQ(c.dx.x, 0.03f);
  EXPECT_FLOAT_EQ(c.dy.y, 0.04f);
}

// The change of st when the point moves by a small fraction of dpdx or dpdy.
Vec2 Difference(const TextureMapping& mapping, TextureContext context, Vec3 step) {
  constexpr float kShare = 0.05f;
  const Point2 from = mapping.Map2(context).st;
  context.p += step * kShare;
  const Point2 to = mapping.Map2(context).st;
  return (to - from) * (1 / kShare);
}

TEST(TextureMapping, CylindricalDerivativesAreThoseOfTheMap) {
  const TextureMapping mapping = OfKind(TextureMapping::Kind::kCylindrical);
  const TextureContext context = ContextAt({0.8f, -0.5f, 0.3f});
  const TextureCoordinates2 c = mapping.Map2(context);
  const Vec2 dx = Difference(mapping, context, context.dpdx), dy = Difference(mapping, context, context.dpdy);
  EXPECT_NEAR(c.dx.x, dx.x, 2e-4f);
  EXPECT_NEAR(c.dx.y, dx.y, 2e-4f);
  EXPECT_NEAR(c.dy.x, dy.x, 2e-4f);
  EXPECT_NEAR(c.dy.y, dy.y, 2e-4f);
}

TEST(TextureMapping, SphericalDerivativesAreThoseOfTheOtherCoordinateAsInPbrt) {
  const TextureMapping mapping = OfKind(TextureMapping::Kind::kSpherical);
  const TextureContext context = ContextAt({0.8f, 0.5f, 0.3f});
  const TextureCoordinates2 c = mapping.Map2(context);
  const Vec2 dx = Difference(mapping, context, context.dpdx);
  EXPECT_NEAR(c.dx.x, dx.y, 2e-4f);
  EXPECT_NEAR(c.dx.y, dx.x, 2e-4f);
}

TEST(TextureMapping, CoordinatesStayFiniteOnTheAxis) {
  for (const TextureMapping::Kind kind :
       {TextureMapping::Kind::kSpherical, TextureMapping::Kind::kCylindrical}) {
    for (const Point3 p : {Point3{0, 0, 1}, Point3{0, 0, 0}, Point3{INFINITY, NAN, 0}}) {
      const TextureCoordinates2 c = OfKind(kind).Map2(ContextAt(p));
      for (const float v : {c.st.x, c.st.y, c.dx.x, c.dx.y, c.dy.x, c.dy.y}) EXPECT_TRUE(std::isfinite(v));
    }
  }
}

TEST(TextureMapping, SpaceIsTransformedBeforeTheLookup) {
  TextureMapping mapping = SpaceMapping(Scale(2, 2, 2) * Translate({1, 0, 0}));
  const TextureCoordinates3 c = mapping.Map3(ContextAt({1, 2, 3}));
  EXPECT_EQ(c.p, (Point3{4, 4, 6}));
  EXPECT_FLOAT_EQ(c.dpdx.x, 0.04f);
}

}  // namespace
}  // namespace tessera
