#include "renderer/math/transform.h"

#include <gtest/gtest.h>

#include "renderer/math/flat_transform.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

void ExpectNear(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

float Signed(TestRandom& random) {
  return 2 * random.Next() - 1;
}

Vec3 RandomVector(TestRandom& random) {
  const float x = Signed(random);
  const float y = Signed(random);
  const float z = Signed(random);
  return {x, y, z};
}

// A chain of rotations, scales and translations.
Transform RandomTransform(TestRandom& random) {
  const Transform rotate = Rotate(360 * random.Next(), RandomVector(random));
  const Transform translate = Translate(RandomVector(random) * 5);
  const float x = 0.3f + random.Next();
  const float y = -0.3f - random.Next();
  const float z = 0.3f + random.Next();
  return translate * rotate * Scale(x, y, z);
}

TEST(Transform, TheInverseUndoesTheMatrix) {
  TestRandom random(1);
  for (int i = 0; i < 200; ++i) {
    const Transform t = RandomTransform(random);
    const std::optional<Transform> from_matrix = Transform::FromMatrix(t.matrix());
    ASSERT_TRUE(from_matrix.has_value());
    const Point3 p = RandomVector(random);
    ExpectNear(t.Inverse().ToPoint(t.ToPoint(p)), p, 1e-5f);
    ExpectNear(from_matrix->Inverse().ToPoint(t.ToPoint(p)), p, 1e-5f);
    ExpectNear(t.Inverse().ToVector(t.ToVector(p)), p, 1e-5f);
  }
}

// As for a shape and a camera that are both far from the origin.
TEST(Transform, TheExactInverseUndoesAProductWhoseTranslationsCancel) {
  const Vec3 far{1000, 700, -900};
  const Transform product = Translate(-far) * (Translate(far) * Rotate(20, {1, 2, 3}));
  const Transform exact = WithExactInverse(product);
  EXPECT_EQ(exact.matrix(), product.matrix());
  EXPECT_GT(Length(product.Inverse().ToPoint(product.ToPoint({}))), 1e-6f);
  ExpectNear(exact.Inverse().ToPoint(exact.ToPoint({})), {}, 1e-9f);
  const Transform flat(product.matrix(), ZeroMatrix());
  EXPECT_EQ(WithExactInverse(flat), flat);
}

TEST(Transform, RotationsMirrorImagesAndEvenScalesKeepAngles) {
  const Transform turn = Translate({5, 6, 7}) * Rotate(33, {1, 2, 3});
  EXPECT_TRUE(Transform().KeepsAngles());
  EXPECT_TRUE((turn * Scale(-1e-3f, 1e-3f, 1e-3f) * turn).KeepsAngles());
  EXPECT_FALSE((turn * Scale(1, 1.001f, 1) * turn).KeepsAngles());
  Matrix4 shear;
  shear.m[0][1] = 1e-3f;
  EXPECT_FALSE(Transform::FromMatrix(shear)->KeepsAngles());
}

TEST(Transform, TheAffineInverseIsTheInverse) {
  TestRandom random(4);
  for (int i = 0; i < 200; ++i) {
    const Matrix4 matrix = RandomTransform(random).matrix();
    const std::optional<Matrix4> affine = AffineInverse(matrix), inverse = Inverse(matrix);
    ASSERT_TRUE(affine && inverse);
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column)
        EXPECT_FLOAT_EQ(affine->m[row][column], inverse->m[row][column]);
    }
  }
  EXPECT_FALSE(AffineInverse(ZeroMatrix()));
  Matrix4 tiny;
  for (int i = 0; i < 3; ++i) tiny.m[i][i] = 1e-39f;
  EXPECT_FALSE(AffineInverse(tiny));
}

TEST(Transform, ProductsApplyTheRightFactorFirst) {
  TestRandom random(2);
  const Transform a = RandomTransform(random), b = RandomTransform(random);
  const Point3 p{0.5f, -0.25f, 2};
  ExpectNear((a * b).ToPoint(p), a.ToPoint(b.ToPoint(p)), 1e-5f);
  ExpectNear((a * b).Inverse().ToPoint(p), b.Inverse().ToPoint(a.Inverse().ToPoint(p)), 1e-4f);
}

TEST(Transform, NormalsStayOrthogonalToTheirSurface) {
  TestRandom random(3);
  for (int i = 0; i < 200; ++i) {
    const Transform t = RandomTransform(random);
    const Vec3 u = RandomVector(random), v = RandomVector(random);
    const Normal3 n = t.ToNormal(Cross(u, v));
    EXPECT_NEAR(Dot(n, t.ToVector(u)), 0, 1e-5f);
    EXPECT_NEAR(Dot(n, t.ToVector(v)), 0, 1e-5f);
  }
}

TEST(Transform, SingularAndInfiniteMatricesHaveNoTransform) {
  Matrix4 singular;
  singular.m[1] = singular.m[0];
  EXPECT_FALSE(Inverse(singular).has_value());
  EXPECT_EQ(Determinant(singular), 0);
  Matrix4 infinite;
  infinite.m[2][2] = INFINITY;
  EXPECT_FALSE(Transform::FromMatrix(infinite).has_value());
  Matrix4 tiny;
  tiny.m[0][0] = 1e-44f;  // its inverse is no float
  EXPECT_FALSE(Transform::FromMatrix(tiny).has_value());
}

TEST(Transform, DeterminantIsTheSignedVolume) {
  EXPECT_FLOAT_EQ(Determinant(Scale(2, 3, 4).matrix()), 24);
  EXPECT_FLOAT_EQ(Determinant(Scale(2, -3, 4).matrix()), -24);
  EXPECT_NEAR(Determinant(Rotate(33, {1, 2, 3}).matrix()), 1, 1e-6f);
  Matrix4 swapped;
  std::swap(swapped.m[0], swapped.m[1]);
  EXPECT_EQ(Determinant(swapped), -1);
}

TEST(Transform, MirrorsSwapHandedness) {
  EXPECT_FALSE(Transform().SwapsHandedness());
  EXPECT_TRUE(Scale(-1, 1, 1).SwapsHandedness());
  EXPECT_FALSE(Scale(-1, -1, 1).SwapsHandedness());
  EXPECT_TRUE(Scale(1e-25f, -1e-25f, 1e-25f).SwapsHandedness());
  EXPECT_FALSE(Rotate(120, {1, 1, 0}).SwapsHandedness());
}

TEST(Transform, RotationsTurnByTheRightHandRule) {
  ExpectNear(Rotate(90, {0, 0, 1}).ToVector({1, 0, 0}), {0, 1, 0}, 1e-6f);
  ExpectNear(Rotate(90, {1, 0, 0}).ToVector({0, 1, 0}), {0, 0, 1}, 1e-6f);
  ExpectNear(Rotate(90, {0, 5, 0}).ToVector({0, 0, 1}), {1, 0, 0}, 1e-6f);
  ExpectNear(Rotate(120, {1, 1, 1}).ToVector({1, 0, 0}), {0, 1, 0}, 1e-6f);
  ExpectNear(Rotate(70, {1, 2, 3}).ToVector({1, 2, 3}), {1, 2, 3}, 1e-5f);
}

TEST(Transform, LookAtPutsTheViewAlongZAndUpAlongY) {
  const Point3 eye{1, 2, 3}, look{4, -1, 5};
  const std::optional<Transform> camera_from_world = LookAt(eye, look, {0, 3, 0});
  ASSERT_TRUE(camera_from_world.has_value());
  ExpectNear(camera_from_world->ToPoint(eye), {0, 0, 0}, 1e-5f);
  ExpectNear(camera_from_world->ToPoint(look), {0, 0, Distance(eye, look)}, 1e-5f);
  const Vec3 up = camera_from_world->ToVector({0, 1, 0});
  EXPECT_NEAR(up.x, 0, 1e-6f);
  EXPECT_GT(up.y, 0);
  // Left-handed, as in pbrt: with z forward and y up, x is to the right.
  EXPECT_FALSE(camera_from_world->SwapsHandedness());
  const std::optional<Transform> along_z = LookAt({0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  ASSERT_TRUE(along_z.has_value());
  EXPECT_TRUE(along_z->IsIdentity());
}

TEST(Transform, LookAtWithoutADirectionIsNone) {
  EXPECT_FALSE(LookAt({1, 2, 3}, {1, 2, 3}, {0, 1, 0}).has_value());
  EXPECT_FALSE(LookAt({0, 0, 0}, {0, 5, 0}, {0, 1, 0}).has_value());
  EXPECT_FALSE(LookAt({0, 0, 0}, {0, 0, 5}, {0, 0, 0}).has_value());
  EXPECT_FALSE(LookAt({0, 0, 0}, {0, 0, 5}, {0, 1e-30f, 0}).has_value());
}

TEST(Transform, PerspectiveMapsNearAndFarAndTheEdgeOfTheView) {
  const Transform t = Perspective(60, 0.5f, 100);
  EXPECT_NEAR(t.ToPoint({0, 0, 0.5f}).z, 0, 1e-6f);
  EXPECT_NEAR(t.ToPoint({0, 0, 100}).z, 1, 1e-5f);
  const float edge = std::tan(Radians(30));
  EXPECT_NEAR(t.ToPoint({7 * edge, 0, 7}).x, 1, 1e-5f);
  EXPECT_NEAR(t.ToPoint({0, -3 * edge, 3}).y, -1, 1e-5f);
  ExpectNear(t.Inverse().ToPoint(t.ToPoint({0.3f, -0.2f, 2})), {0.3f, -0.2f, 2}, 1e-4f);
}

TEST(Transform, BoxesHoldTheImagesOfTheirPoints) {
  TestRandom random(4);
  Bounds3 box;
  box.Add(Point3{-1, -2, -3});
  box.Add(Point3{1, 2, 3});
  for (int i = 0; i < 100; ++i) {
    const Transform t = RandomTransform(random);
    const Bounds3 image = t.ToBounds(box);
    const Vec3 v = RandomVector(random);
    const Point3 p = t.ToPoint({v.x, 2 * v.y, 3 * v.z});
    EXPECT_TRUE(image.Contains(p));
  }
  const Bounds3 moved = Translate({1, 1, 1}).ToBounds(box);
  EXPECT_EQ(moved.min, (Vec3{0, -1, -2}));
  EXPECT_EQ(moved.max, (Vec3{2, 3, 4}));
}

TEST(Transform, TransposeMirrorsAtTheDiagonal) {
  Matrix4 m;
  m.m[0][3] = 7;
  EXPECT_EQ(Transpose(m).m[3][0], 7);
  EXPECT_EQ(Transpose(Transpose(m)), m);
}

}  // namespace
}  // namespace tessera
