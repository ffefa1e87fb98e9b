// Points on the triangles of eight lanes are those of the triangles one by one.
#include "renderer/shape/triangle_lanes.h"

#include <gtest/gtest.h>

#include <array>

#include "renderer/shape/shape_interaction.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

float Random(uint32_t i, uint32_t which) {
  return 2 * UniformFloatFromHash(Hash(i, which)) - 1;
}
Vec3 RandomVector(uint32_t i, uint32_t which) {
  return {Random(i, 3 * which), Random(i, 3 * which + 1), Random(i, 3 * which + 2)};
}

// A triangle, ordinary or not, and a ray that meets its plane.
struct Example {
  TriangleMesh mesh;
  Ray ray;
  Hit hit;
};
Example MakeExample(uint32_t i) {
  Example example;
  TriangleMesh& mesh = example.mesh;
  Point3 corners[3] = {RandomVector(i, 0), RandomVector(i, 1), RandomVector(i, 2)};
  const Point3 target = corners[0] * 0.4f + corners[1] * 0.35f + corners[2] * 0.25f;
  Vec3 d = RandomVector(i, 3);
  switch (i % 16) {
    case 0: corners[2] = corners[0]; break;                                  // no area
    case 1: corners[2] = corners[0] + (corners[1] - corners[0]) * 2; break;  // the same
    case 2: d = corners[1] - corners[0]; break;                              // edge on
    case 3: corners[1] = corners[1] * 1e-16f; break;
    case 4:  // an area whose square underflows
      for (Point3& corner : corners) corner = corner * 1e-12f;
      break;
    case 5: corners[0] = {0, 0, 0}; break;
    default: break;
  }
  mesh.P.assign(corners, corners + 3);
  mesh.indices = {0, 1, 2};
  mesh.flip_normals = i % 3 == 0;
  if (i % 2 == 0) mesh.N = {RandomVector(i, 4), RandomVector(i, 5), RandomVector(i, 6)};
  if (i % 32 == 6) mesh.N[2] = mesh.N[0] = mesh.N[1] = {0, 0, 0};  // normals that cancel
  // Some begin beyond the triangle.
  example.ray = {target - d * (i % 5 == 0 ? -0.5f : 1.5f), d};
  example.ray.time = Random(i, 30);
  example.hit.u = 0.35f;
  example.hit.v = 0.25f;
  return example;
}

void ExpectEqual(Vec3 actual, Float8 x, Float8 y, Float8 z, int lane) {
  std::array<float, kLanes> a, b, c;
  x.Store(a.data());
  y.Store(b.data());
  z.Store(c.data());
  const Vec3 expected{a[lane], b[lane], c[lane]};
  EXPECT_EQ(actual, expected);
}
void ExpectEqual(Vec3 actual, const Vec3x8& lanes, int lane) {
  ExpectEqual(actual, lanes.x, lanes.y, lanes.z, lane);
}

TEST(TriangleLanes, PointsAndNormalsAreThoseOfOneTriangle) {
  int defined_count = 0, refused_count = 0;
  for (uint32_t round = 0; round < 2000; ++round) {
    std::array<Example, kLanes> examples;
    TrianglePlaces8 places;
    const Ray* rays[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      examples[lane] = MakeExample(round * kLanes + static_cast<uint32_t>(lane));
      const TriangleMesh& mesh = examples[lane].mesh;
      places.points[lane] = mesh.P.data();
      places.normals[lane] = (mesh.N.empty() ? mesh.P : mesh.N).data();
      places.corners[lane] = mesh.indices.data();
      places.smooth |= LaneSet{!mesh.N.empty()} << lane;
      places.flipped |= LaneSet{mesh.flip_normals} << lane;
      rays[lane] = &examples[lane].ray;
    }
    SurfacePoints8 points;
    const LaneSet defined = FindPoints(places, Rays8(kAllLanes, rays), &points);
    ForEachLane(defined, [&](int lane) {
      Example& example = examples[lane];
      const HitRay hit_ray{example.ray, nullptr, false, false};
      ASSERT_TRUE(example.mesh.Refine(hit_ray, &example.hit)) << "the hit is false";
      SurfaceInteraction interaction;
      example.mesh.FillInteraction(example.hit, hit_ray, &interaction);
      ExpectEqual(interaction.p, points.p, lane);
      ExpectEqual(interaction.p_error, points.p_error, lane);
      ExpectEqual(interaction.n, points.n, lane);
      ExpectEqual(interaction.shading.n, points.shading_n, lane);
    });
    // What is left out is rare: hits that are false, or triangles that have hardly an area.
    ForEachLane(kAllLanes & ~defined, [&](int lane) {
      Example& example = examples[lane];
      const float u = example.hit.u;
      const bool is_true = example.mesh.Refine({example.ray, nullptr, false, false}, &example.hit);
      const bool is_edge_on = is_true && example.hit.u == u;
      const auto [p0, p1, p2] = example.mesh.At(0);
      EXPECT_TRUE(!is_true || is_edge_on || LengthSquared(Cross(p0 - p2, p1 - p2)) < 1e-29f);
    });
    defined_count += std::popcount(defined);
    refused_count += kLanes - std::popcount(defined);
    if (HasFailure()) return;
  }
  EXPECT_GT(defined_count, 8000);
  EXPECT_GT(refused_count, 2000);
}

}  // namespace
}  // namespace tessera
