#include "renderer/shape/displaced_mesh.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "tests/renderer/shape/built_shape.h"

namespace tessera {
namespace {

// Two triangles of different sizes that share an edge.
MeshData Kite() {
  MeshData mesh;
  mesh.P = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-3, 2, 0}};
  for (const Point3 p : mesh.P) mesh.uv.push_back({p.x, p.y});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

Displacement Flat(float edge_length) {
  return {edge_length, Transform(), [](Point3, Normal3, Point2) { return 0.0f; }};
}

double AreaOf(const MeshData& mesh) {
  double area = 0;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Point3 p = mesh.P[mesh.indices[i]];
    area += Length(Cross(mesh.P[mesh.indices[i + 1]] - p, mesh.P[mesh.indices[i + 2]] - p)) / 2;
  }
  return area;
}

TEST(DisplacedMesh, IsRefinedUntilNoEdgeIsTooLong) {
  const Result<MeshData> mesh = Displace(Kite(), Flat(0.2f));
  ASSERT_TRUE(mesh) << mesh.error().message;
  for (size_t i = 0; i < mesh->indices.size(); i += 3) {
    for (size_t j = 0; j < 3; ++j)
      EXPECT_LT(Length(mesh->P[mesh->indices[i + j]] - mesh->P[mesh->indices[i + (j + 1) % 3]]), 0.2f);
  }
  EXPECT_NEAR(AreaOf(*mesh), AreaOf(Kite()), 1e-4);
  for (size_t i = 0; i < mesh->P.size(); ++i) {
    EXPECT_NEAR(mesh->uv[i].x, mesh->P[i].x, 1e-5f);
    EXPECT_NEAR(mesh->uv[i].y, mesh->P[i].y, 1e-5f);
  }
}

TEST(DisplacedMesh, HasNoCracks) {
  const Result<MeshData> mesh = Displace(Kite(), Flat(0.1f));
  ASSERT_TRUE(mesh);
  // Every edge belongs to two triangles, or to one on the border of the kite.
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (size_t i = 0; i < mesh->indices.size(); i += 3) {
    for (size_t j = 0; j < 3; ++j) {
      const uint32_t a = mesh->indices[i + j], b = mesh->indices[i + (j + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  }
  double border = 0;
  for (const auto& [edge, count] : edges) {
    ASSERT_LE(count, 2);
    if (count == 1) border += Length(mesh->P[edge.first] - mesh->P[edge.second]);
  }
  EXPECT_NEAR(border, 2 + std::sqrt(17.0) + std::sqrt(13.0), 1e-4);
}

TEST(DisplacedMesh, EdgesAreMeasuredInRenderingSpace) {
  Displacement small = Flat(1);
  small.render_from_object = Scale(0.1f, 0.1f, 0.1f);
  const Result<MeshData> mesh = Displace(Kite(), small);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->P.size(), 4u);
}

TEST(DisplacedMesh, VerticesMoveAlongTheirNormalsAndNormalsFollow) {
  const Displacement slope{0.05f, Transform(), [](Point3, Normal3, Point2 uv) { return 0.5f * uv.x; }};
  const Result<MeshData> mesh = Displace(Kite(), slope);
  ASSERT_TRUE(mesh);
  const Normal3 expected = Normalize(Vec3{-0.5f, 0, 1});
  for (size_t i = 0; i < mesh->P.size(); ++i) {
    EXPECT_NEAR(mesh->P[i].z, 0.5f * mesh->uv[i].x, 1e-5f);
    EXPECT_GT(Dot(mesh->N[i], expected), 0.999f);
  }
}

TEST(DisplacedMesh, OfHugeOrDegenerateTrianglesEnds) {
  MeshData line = Kite();
  for (Point3& p : line.P) p.y = 0;
  EXPECT_TRUE(Displace(line, Flat(0.1f)));
  // Edges whose length is not finite are split until floats end: what cannot be split is kept.
  MeshData point = Kite();
  for (Point3& p : point.P) p = {3e38f, 3e38f, 3e38f};
  EXPECT_TRUE(Displace(point, Flat(1e-30f)));
}

TEST(DisplacedMesh, OfEdgesShorterThanFloatsResolveEnds) {
  // A few units in the last place wide: nearly every split is decided by rounding.
  MeshData far = Kite();
  for (Point3& p : far.P) p = p * 1e-5f + Vec3{10.3f, 20.7f, 5.1f};
  for (const float edge : {1e-30f, 1e-7f, 1e-6f}) {
    const Result<MeshData> mesh = Displace(far, Flat(edge));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_LT(mesh->indices.size(), 3000u);
  }
}

TEST(DisplacedMesh, OfTooManyTrianglesIsRefusedBeforeTheyAreMade) {
  const Result<MeshData> mesh = Displace(Kite(), Flat(1e-5f));
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().message, "edges of length 1e-05 would make more than 67108864 triangles");
}

TEST(DisplacedMesh, OfAPlyFileTakesItsHeightsFromATexture) {
  const std::string head =
      "Texture \"h\" \"float\" \"scale\" \"float tex\" 0.25 Shape \"plymesh\" \"string filename\" \"uv.ply\" "
      "\"texture displacement\" \"h\" ";
  const Built built = Build(head + "\"float edgelength\" 0.4");
  const TriangleMesh& mesh = Only<TriangleMesh>(built);
  EXPECT_GT(mesh.P.size(), 9u);
  for (const Point3 p : mesh.P) EXPECT_NEAR(std::abs(p.z), 0.25f, 1e-6f);
  EXPECT_EQ(Build(head + "\"float edgelength\" 0").error, "a.pbrt:2:116: edgelength must be above 0");
}

}  // namespace
}  // namespace tessera
