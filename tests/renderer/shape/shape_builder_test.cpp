// From Shape directives to geometry: parameters, defaults, warnings and errors.
#include <gmock/gmock.h>

#include "tests/renderer/shape/built_shape.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ShapeBuilder, QuadricsHavePbrtsDefaults) {
  const Built sphere_built = Build("Shape \"sphere\"");
  const Quadric& sphere = Only<Quadric>(sphere_built);
  EXPECT_EQ(sphere.radius, 1);
  EXPECT_EQ(sphere.z_min, -1);
  EXPECT_EQ(sphere.z_max, 1);
  EXPECT_EQ(sphere.phi_max, 2 * kPi);
  EXPECT_FALSE(sphere_built.shapes[0].surface.HasAlpha());
  const Built big_built = Build("Shape \"sphere\" \"float radius\" 3 \"float zmax\" -5");
  EXPECT_EQ(Only<Quadric>(big_built).z_min, -3);
  EXPECT_EQ(Only<Quadric>(big_built).z_max, -3);
  const Built disk_built =
      Build("Shape \"disk\" \"float height\" 2 \"float innerradius\" .5 \"float phimax\" 90");
  const Quadric& disk = Only<Quadric>(disk_built);
  EXPECT_EQ(disk.z_min, 2);
  EXPECT_EQ(disk.inner_radius, 0.5f);
  EXPECT_FLOAT_EQ(disk.phi_max, kPi / 2);
  const Built cylinder_built = Build("Shape \"cylinder\" \"float zmin\" 4 \"float zmax\" 2");
  EXPECT_EQ(Only<Quadric>(cylinder_built).z_min, 2);
  EXPECT_EQ(Only<Quadric>(cylinder_built).z_max, 4);
}

TEST(ShapeBuilder, NormalsFlipWithOrientationOrHandednessButNotBoth) {
  const std::string shape = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
  EXPECT_FALSE(Only<TriangleMesh>(Build(shape)).flip_normals);
  EXPECT_TRUE(Only<TriangleMesh>(Build("ReverseOrientation " + shape)).flip_normals);
  EXPECT_TRUE(Only<TriangleMesh>(Build("Scale -1 1 1 " + shape)).flip_normals);
  EXPECT_FALSE(Only<TriangleMesh>(Build("ReverseOrientation Scale -1 1 1 " + shape)).flip_normals);
  EXPECT_TRUE(Only<Quadric>(Build("Scale -1 1 1 Shape \"sphere\"")).flip_normals);
}

TEST(ShapeBuilder, MeshesAreInRenderingSpaceWithRoomForOneMoreVertex) {
  const Built built = Build(
      "ReverseOrientation Translate 1 2 3 Scale 2 2 4\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 1] \"normal N\" [0 0 1 0 1 0 1 0 0]\n"
      "\"vector3 S\" [1 0 0 0 1 0 0 0 1] \"point2 uv\" [0 0 1 0 .5 1]");
  const TriangleMesh& mesh = Only<TriangleMesh>(built);
  EXPECT_EQ(mesh.P[2], (Point3{1, 4, 7}));
  EXPECT_EQ(mesh.N[0], (Normal3{0, 0, -0.25f}));  // by the inverse transpose, reversed
  EXPECT_EQ(mesh.S[2], (Vec3{0, 0, 4}));
  EXPECT_EQ(mesh.uv[2], (Point2{0.5f, 1}));
  EXPECT_EQ(mesh.indices, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_GT(mesh.P.capacity(), mesh.P.size());
  EXPECT_THAT(built.diagnostics.WarningTexts(), IsEmpty());
}

TEST(ShapeBuilder, ListsOfTheWrongLengthAreIgnoredWithAWarning) {
  const Built built = Build(
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1] \"point2 uv\" [0 0]\n"
      "  \"integer indices\" [0 1 2 1]");
  const TriangleMesh& mesh = Only<TriangleMesh>(built);
  EXPECT_TRUE(mesh.N.empty());
  EXPECT_TRUE(mesh.uv.empty());
  EXPECT_EQ(mesh.indices.size(), 3u);
  EXPECT_THAT(built.diagnostics.WarningTexts(),
              ElementsAre("a.pbrt:3:3: 4 indices are not a multiple of 3; the last 1 is ignored",
                          "a.pbrt:2:72: \"uv\" is ignored: it has 1 values for 3 points",
                          "a.pbrt:2:53: \"N\" is ignored: it has 1 values for 3 points"));
}

TEST(ShapeBuilder, ABilinearMeshOfFourPointsNeedsNoIndices) {
  const Built built = Build("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]");
  EXPECT_EQ(Only<BilinearMesh>(built).indices, (std::vector<uint32_t>{0, 1, 2, 3}));
}

TEST(ShapeBuilder, APlyFileOfTrianglesAndQuadsYieldsTwoShapes) {
  for (const std::string name : {"quad.ply", "quad.ply.gz"}) {
    const Built built = Build("Shape \"plymesh\" \"string filename\" \"" + name + "\"");
    ASSERT_EQ(built.shapes.size(), 2u) << built.error;
    const auto& triangles = std::get<TriangleMesh>(built.shapes[0].form);
    const auto& patches = std::get<BilinearMesh>(built.shapes[1].form);
    EXPECT_EQ(triangles.P, (std::vector<Point3>{{0, 0, 0}, {5, 5, 5}, {6, 6, 7}}));
    EXPECT_EQ(triangles.indices, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(patches.P.size(), 4u);
    EXPECT_EQ(patches.P[patches.indices[3]], (Point3{1, 1, 0}));  // opposite to corner 0
  }
}

TEST(ShapeBuilder, AlphaIsANumberOrATexture) {
  const Built number = Build("Shape \"sphere\" \"float alpha\" .25");
  ASSERT_EQ(number.shapes.size(), 1u);
  EXPECT_EQ(number.shapes[0].surface.alpha.constant, 0.25f);
  EXPECT_TRUE(number.shapes[0].surface.HasAlpha());
  const Built texture = Build(
      "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" 1\n"
      "Shape \"sphere\" \"texture alpha\" \"t\"");
  ASSERT_EQ(texture.shapes.size(), 1u) << texture.error;
  EXPECT_FALSE(texture.shapes[0].surface.alpha.IsConstant());
}

TEST(ShapeBuilder, ErrorsNameTheProblemAndItsLocation) {
  const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
  EXPECT_EQ(Build("Shape \"spere\"").error, "a.pbrt:2:1: unknown shape \"spere\" (did you mean \"sphere\"?)");
  EXPECT_EQ(Build("Shape \"sphere\" \"float radius\" 0").error, "a.pbrt:2:16: radius must be above 0");
  EXPECT_EQ(Build("Shape \"plymesh\"").error, "a.pbrt:2:1: plymesh needs \"string filename\"");
  EXPECT_EQ(Build("Shape \"plymesh\" \"string filename\" \"no.ply\"").error,
            "a.pbrt:2:17: no.ply: cannot be opened: No such file or directory");
  EXPECT_EQ(Build("Shape \"plymesh\" \"string filename\" \"half.ply\"").error,
            "a.pbrt:2:17: half.ply: truncated: face 1 of 2 is cut off");
  EXPECT_EQ(Build("Texture \"d\" \"float\" \"constant\" Shape \"plymesh\" \"string filename\" \"quad.ply\" "
                  "\"texture displacement\" \"d\"")
                .error,
            "a.pbrt:2:77: displacement needs a mesh with texture coordinates");
  EXPECT_EQ(Build("Scale 10 1 1 Shape \"trianglemesh\" \"point3 P\" [0 0 0 2e38 0 0 0 1 0]").error,
            "a.pbrt:2:14: the shape is not within +-1e+17 in rendering space");
}

TEST(ShapeBuilder, AnUnknownParameterIsAnError) {
  const Built built = Build("Shape \"sphere\" \"float raduis\" 2");
  EXPECT_THAT(built.error, testing::HasSubstr("raduis"));
  EXPECT_THAT(built.error, testing::StartsWith("a.pbrt:2:"));
}

}  // namespace
}  // namespace tessera
