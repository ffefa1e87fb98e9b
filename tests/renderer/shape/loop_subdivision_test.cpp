// Loop subdivision: topology, masks, limits and errors.
#include "renderer/shape/loop_subdivision.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/renderer/shape/built_shape.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera {
namespace {

// A closed mesh with vertices of valence 4 (the poles: 6) and random positions around a ball.
MeshData LumpyBall() {
  TestRandom random(31);
  MeshData mesh;
  for (int i = 0; i < 6; ++i) {
    const float phi = kPi / 3 * static_cast<float>(i);
    mesh.P.push_back(Point3{std::cos(phi), std::sin(phi), 0} + RandomPoint(random, 0.2f));
  }
  mesh.P.push_back({0, 0, 1});
  mesh.P.push_back({0.1f, 0, -1});
  for (uint32_t i = 0; i < 6; ++i) {
    mesh.indices.insert(mesh.indices.end(), {i, (i + 1) % 6, 6});
    mesh.indices.insert(mesh.indices.end(), {(i + 1) % 6, i, 7});
  }
  return mesh;
}

MeshData Tetrahedron() {
  MeshData mesh;
  mesh.P = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1};
  return mesh;
}

// (side + 1)^2 points at (x, y) = (i, j), two triangles for each square, counterclockwise from above.
MeshData Grid(uint32_t side) {
  MeshData mesh;
  for (uint32_t j = 0; j <= side; ++j) {
    for (uint32_t i = 0; i <= side; ++i) mesh.P.push_back({static_cast<float>(i), static_cast<float>(j), 0});
  }
  for (uint32_t j = 0; j < side; ++j) {
    for (uint32_t i = 0; i < side; ++i) {
      const uint32_t a = j * (side + 1) + i, b = a + 1, c = a + side + 1, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

MeshData Subdivide(const MeshData& control, int levels) {
  Result<MeshData> mesh = SubdivideLoop(control, levels);
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
  return mesh ? *std::move(mesh) : MeshData{};
}

TEST(LoopSubdivision, EveryLevelCutsTrianglesIntoFourThatShareVertices) {
  for (const MeshData& control : {LumpyBall(), Tetrahedron()}) {
    for (int levels = 0; levels < 5; ++levels) {
      const MeshData mesh = Subdivide(control, levels);
      ASSERT_EQ(mesh.indices.size(), control.indices.size() << (2 * levels));
      // Euler: V - E + F = 2 on a closed surface, where E = 3/2 F.
      const size_t faces = mesh.indices.size() / 3;
      EXPECT_EQ(mesh.P.size(), 2 + faces / 2);
      EXPECT_EQ(mesh.N.size(), mesh.P.size());
      std::set<std::pair<uint32_t, uint32_t>> edges;
      for (size_t i = 0; i < mesh.indices.size(); ++i)
        edges.insert({mesh.indices[i], mesh.indices[i % 3 == 2 ? i - 2 : i + 1]});
      EXPECT_EQ(edges.size(), mesh.indices.size());  // each direction once: neighbours run against each other
    }
  }
}

TEST(LoopSubdivision, TheLimitDoesNotDependOnTheNumberOfLevels) {
  for (const MeshData& control : {LumpyBall(), Tetrahedron()}) {
    const MeshData coarse = Subdivide(control, 0), fine = Subdivide(control, 5);
    for (size_t i = 0; i < control.P.size(); ++i) {
      EXPECT_LT(Distance(coarse.P[i], fine.P[i]), 2e-6f) << i;
      EXPECT_GT(Distance(coarse.P[i], control.P[i]), 0.05f) << i;
    }
    // Normals are made of points of the limit, which is exact only in the limit.
    const MeshData middle = Subdivide(control, 3), finer = Subdivide(control, 4);
    for (size_t i = 0; i < middle.P.size(); ++i) {
      EXPECT_LT(Distance(middle.P[i], finer.P[i]), 2e-6f) << i;
      EXPECT_GT(Dot(Normalize(middle.N[i]), Normalize(finer.N[i])), 0.99f) << i;
    }
  }
}

TEST(LoopSubdivision, NormalsAreThoseOfTheLimitSurfaceOnTheSideThatPbrtHasThem) {
  const MeshData mesh = Subdivide(LumpyBall(), 5);
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const uint32_t* v = &mesh.indices[i];
    const Vec3 cross = Normalize(Cross(mesh.P[v[1]] - mesh.P[v[0]], mesh.P[v[2]] - mesh.P[v[0]]));
    for (int k = 0; k < 3; ++k) EXPECT_LT(Dot(cross, Normalize(mesh.N[v[k]])), -0.98f) << i;
  }
}

TEST(LoopSubdivision, AFlatGridStaysFlatAndItsInsideEven) {
  const MeshData mesh = Subdivide(Grid(4), 2);
  EXPECT_LT(Distance(mesh.P[2 * 5 + 2], {2, 2, 0}), 1e-6f);
  EXPECT_LT(Distance(mesh.P[1 * 5 + 2], {2, 1, 0}), 1e-6f);
  for (size_t i = 0; i < mesh.P.size(); ++i) {
    EXPECT_EQ(mesh.P[i].z, 0);
    EXPECT_NEAR(mesh.N[i].x, 0, 1e-6);
    EXPECT_NEAR(mesh.N[i].y, 0, 1e-6);
    EXPECT_LT(mesh.N[i].z, 0);
  }
  // Boundaries stay on their lines, but for the corners, which are cut.
  EXPECT_LT(Distance(mesh.P[2], {2, 0, 0}), 1e-6f);
  EXPECT_GT(mesh.P[0].x, 0.1f);
}

TEST(LoopSubdivision, TheBoundaryDependsOnTheBoundaryOnly) {
  MeshData control = Grid(3);
  const MeshData flat = Subdivide(control, 3);
  control.P[5].z = 10;
  control.P[6].z = -7;
  const MeshData bent = Subdivide(control, 3);
  for (const size_t corner : {0u, 1u, 2u, 3u, 4u, 7u, 8u, 15u}) EXPECT_EQ(flat.P[corner], bent.P[corner]);
}

TEST(LoopSubdivision, BoundaryNormalsPointTheSameWayForEveryValence) {
  for (uint32_t triangles = 1; triangles <= 7; ++triangles) {
    MeshData fan;
    fan.P.push_back({0, 0, 0});
    for (uint32_t i = 0; i <= triangles; ++i) {
      const float phi = kPi * static_cast<float>(i) / static_cast<float>(triangles + 1);
      fan.P.push_back({std::cos(phi), std::sin(phi), 0});
      if (i > 0) fan.indices.insert(fan.indices.end(), {0, i, i + 1});
    }
    for (const int levels : {0, 2}) EXPECT_LT(Subdivide(fan, levels).N[0].z, 0) << triangles;
  }
}

TEST(LoopSubdivision, MeshesThatAreNoSurfaceAreRefused) {
  MeshData mesh = Tetrahedron();
  std::swap(mesh.indices[0], mesh.indices[1]);
  EXPECT_THAT(SubdivideLoop(mesh, 1).error().message, testing::HasSubstr("same orientation"));
  mesh = Tetrahedron();
  mesh.P.push_back({0, 0, 0});
  mesh.indices.insert(mesh.indices.end(), {0, 1, 4});
  EXPECT_EQ(SubdivideLoop(mesh, 1).error().message,
            "triangles 0, 2 and 4 share the edge of points 0 and 1; at most two may");
  mesh.indices = {0, 1, 1};
  EXPECT_EQ(SubdivideLoop(mesh, 1).error().message, "triangle 0 has a point twice");
  EXPECT_EQ(SubdivideLoop(Tetrahedron(), 40).error().message, "40 levels make more than 67108864 triangles");
}

TEST(LoopReader, MakesATriangleMeshWithNormals) {
  const std::string tetrahedron =
      "Shape \"loopsubdiv\" \"point3 P\" [1 1 1 1 -1 -1 -1 1 -1 -1 -1 1 9 9 9] "
      "\"integer indices\" [0 1 2 0 2 3 0 3 1 3 2 1] ";
  EXPECT_EQ(Only<TriangleMesh>(Build(tetrahedron)).indices.size(), 3u * 4 * 64);
  const Built built = Build(tetrahedron + "\"integer levels\" 1 \"string scheme\" \"loop\"");
  const TriangleMesh& mesh = Only<TriangleMesh>(built);
  EXPECT_EQ(mesh.indices.size(), 3u * 4 * 4);
  EXPECT_EQ(mesh.P.size(), 10u);  // without the point that no triangle has
  EXPECT_EQ(mesh.N.size(), 10u);
  EXPECT_GT(mesh.P.capacity(), mesh.P.size());
}

TEST(LoopReader, ErrorsNameTheProblemAndItsLocation) {
  EXPECT_EQ(Build("Shape \"loopsubdiv\"").error, "a.pbrt:2:1: loopsubdiv needs \"point3 P\"");
  const std::string points = "Shape \"loopsubdiv\" \"point3 P\" [1 1 1 1 -1 -1 -1 1 -1] ";
  EXPECT_EQ(Build(points).error, "a.pbrt:2:1: loopsubdiv needs \"integer indices\"");
  EXPECT_EQ(Build(points + "\"integer indices\" [0 1 3]").error,
            "a.pbrt:2:55: index 3 is out of range: \"P\" has 3 points");
  EXPECT_EQ(Build(points + "\"integer indices\" [0 1 1]").error, "a.pbrt:2:55: triangle 0 has a point twice");
  EXPECT_EQ(Build(points + "\"integer indices\" [0 1 2] \"integer levels\" -1").error,
            "a.pbrt:2:81: levels must not be negative");
  const Built excess = Build(points + "\"integer indices\" [0 1 2 0]");
  EXPECT_THAT(excess.diagnostics.WarningTexts(),
              testing::ElementsAre("a.pbrt:2:55: 4 indices are not a multiple of 3; the last 1 is ignored"));
}

}  // namespace
}  // namespace tessera
