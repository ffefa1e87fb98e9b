// Embree's answers against brute force in double precision.
#include <gtest/gtest.h>

#include "renderer/accelerator/accelerator.h"
#include "renderer/accelerator/embree_accelerator.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera {
namespace {

std::unique_ptr<Accelerator> Build(const Geometry& geometry, const TextureTable& textures, int threads = 1) {
  Result<std::unique_ptr<Accelerator>> made = MakeEmbreeAccelerator(geometry, textures, threads);
  EXPECT_TRUE(made.has_value());
  return *std::move(made);
}

// Shapes of every kind: soup, closed meshes, flat and twisted patches, whole and cut quadrics.
std::vector<Shape> MixedShapes(uint64_t seed) {
  TestRandom random(seed);
  std::vector<Shape> shapes;
  std::vector<Point3> P;
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < 90; ++i) {
    const Point3 center = RandomPoint(random, 5);
    for (int j = 0; j < 3; ++j) P.push_back(center + RandomPoint(random, 1));
    indices.insert(indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  shapes.push_back(MeshShape(std::move(P), std::move(indices)));
  shapes.push_back(BallMesh(6, {2, 1, 0}, 1.5f));
  for (int i = 0; i < 20; ++i) {
    const Point3 a = RandomPoint(random, 5), u = RandomPoint(random, 2), v = RandomPoint(random, 2);
    const Vec3 twist = i % 2 == 0 ? Vec3{} : RandomPoint(random, 0.7f);
    shapes.push_back(PatchShape(a, a + u, a + v, a + u + v + twist));
  }
  for (int i = 0; i < 30; ++i) {
    const auto kind = static_cast<Quadric::Kind>(i % 3);
    const Transform transform = RandomTransform(random, 5);
    const bool whole = i % 2 == 0;
    shapes.push_back(QuadricShape(kind, transform, 0.7f, whole ? -0.7f : -0.4f, whole ? 0.7f : 0.5f,
                                  whole ? 2 * kPi : 4.f, whole ? 0 : 0.2f));
  }
  return shapes;
}

Ray RandomRay(TestRandom& random, float size) {
  Ray ray;
  ray.o = RandomPoint(random, size);
  ray.d = RandomPoint(random, size) - ray.o;
  return ray;
}

TEST(Embree, FindsTheNearestPrimitiveThatBruteForceFinds) {
  const Geometry geometry{MixedShapes(1), {}, {}};
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  TestRandom random(2);
  int hits = 0, at_edges = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray = RandomRay(random, 8);
    Hit expected, found;
    const bool expect = BruteForceIntersect(geometry, ray, &expected);
    const bool find = accelerator->Intersect(ray, &found);
    if (expect != find ||
        (expect && (found.shape != expected.shape || found.primitive != expected.primitive))) {
      ++at_edges;  // within a rounding error of an edge
      continue;
    }
    if (!expect) continue;
    ++hits;
    ASSERT_NEAR(found.t, expected.t, 1e-5f * expected.t);
    ASSERT_NEAR(found.u, expected.u, 1e-4f);
    ASSERT_NEAR(found.v, expected.v, 1e-4f);
    ASSERT_EQ(accelerator->Occluded(ray), true);
  }
  EXPECT_GT(hits, kRays / 3);
  EXPECT_LE(at_edges, 2);
}

TEST(Embree, ReportsOnlyHitsUpToTheEndOfTheRay) {
  const Geometry geometry{MixedShapes(1), {}, {}};
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  TestRandom random(3);
  for (int i = 0; i < 5000; ++i) {
    Ray ray = RandomRay(random, 8);
    Hit hit;
    if (!accelerator->Intersect(ray, &hit)) {
      ASSERT_FALSE(accelerator->Occluded(ray));
      continue;
    }
    ASSERT_GT(hit.t, 0);
    Hit other;
    ray.t_max = hit.t * 0.999f;
    ASSERT_FALSE(accelerator->Intersect(ray, &other));
    ASSERT_FALSE(accelerator->Occluded(ray));
    ray.t_max = hit.t * 1.001f;
    ASSERT_TRUE(accelerator->Intersect(ray, &other));
    ASSERT_TRUE(accelerator->Occluded(ray));
  }
}

TEST(Embree, AGroupInstancedHitsWhereTheFlattenedOneDoes) {
  // Uniform scale keeps quadrics what they are when their transform is multiplied.
  TestRandom random(4);
  Geometry instanced, flat;
  instanced.groups.push_back({MixedShapes(5)});
  instanced.groups.push_back({});  // an empty group may be instanced
  for (int i = 0; i < 4; ++i) {
    const Transform transform = RandomTransform(random, 10);
    instanced.instances.push_back({1, transform});
    instanced.instances.push_back({0, transform});
    for (Shape shape : instanced.groups[0].shapes) {
      if (auto* mesh = std::get_if<TriangleMesh>(&shape.form)) {
        for (Point3& p : mesh->P) p = transform.ToPoint(p);
      } else if (auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
        for (Point3& p : patches->P) p = transform.ToPoint(p);
      } else {
        Quadric& quadric = std::get<Quadric>(shape.form);
        quadric.render_from_object = transform * quadric.render_from_object;
      }
      flat.shapes.push_back(std::move(shape));
    }
  }
  const TextureTable textures;
  const auto a = Build(instanced, textures), b = Build(flat, textures);
  const uint32_t per_group = static_cast<uint32_t>(instanced.groups[0].shapes.size());
  int different = 0, hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = RandomRay(random, 18);
    Hit of_instance, of_flat;
    const bool hit_instance = a->Intersect(ray, &of_instance), hit_flat = b->Intersect(ray, &of_flat);
    if (hit_instance != hit_flat) {
      ++different;
      continue;
    }
    if (!hit_flat) continue;
    const uint32_t shape = of_instance.instance / 2 * per_group + of_instance.shape;
    if (shape != of_flat.shape || of_instance.primitive != of_flat.primitive) {
      ++different;
      continue;
    }
    ++hits;
    const SurfaceInteraction x = MakeInteraction(instanced, of_instance, ray);
    const SurfaceInteraction y = MakeInteraction(flat, of_flat, ray);
    ASSERT_LT(Distance(x.p, y.p), 3e-4f);  // along the surface, seen at a grazing angle
    ASSERT_LE(AbsDot(x.p - y.p, y.n), Dot(x.p_error + y.p_error, Abs(y.n)));
    ASSERT_GT(AbsDot(x.n, y.n), 0.999f);
    ASSERT_LT(Distance(x.dpdu, y.dpdu), 1e-2f * (1 + Length(y.dpdu)));
    for (int axis = 0; axis < 3; ++axis) ASSERT_LT(x.p_error[axis], 1e-3f);
  }
  EXPECT_GT(hits, 5000);
  EXPECT_LE(different, 4);
}

TEST(Embree, AClosedMeshLetsNoRayThrough) {
  const Geometry geometry{{BallMesh(24, {1000, 50, 3}, 10)}, {}, {}};
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  const auto& mesh = std::get<TriangleMesh>(geometry.shapes[0].form);
  TestRandom random(6);
  const Point3 inside{1002, 52, 4};
  Hit hit;
  for (int i = 0; i < 50000; ++i) {
    // At vertices, at edges, and anywhere.
    const auto [p0, p1, p2] = mesh.At(static_cast<uint32_t>(random.Next() * mesh.indices.size() / 3));
    const float along = random.Next();
    const Point3 target = i % 3 == 0   ? p0
                          : i % 3 == 1 ? Lerp(along, p1, p2)
                                       : inside + RandomDirection(random);
    const Ray ray{inside, target - inside};
    ASSERT_TRUE(accelerator->Intersect(ray, &hit));
    ASSERT_TRUE(accelerator->Occluded(ray));
  }
}

TEST(Embree, TwoBuildsWithAnyNumberOfThreadsGiveTheSameBits) {
  Geometry geometry{MixedShapes(1), {}, {}};
  for (int i = 0; i < 12; ++i) geometry.shapes.push_back(BallMesh(60, {i * 0.9f - 5, 1, 2}, 1));
  const TextureTable textures;
  const auto one = Build(geometry, textures, 1), two = Build(geometry, textures, 2);
  const auto again = Build(geometry, textures, 2);
  TestRandom random(7);
  int different = 0;
  const auto& mesh = std::get<TriangleMesh>(geometry.shapes.back().form);
  for (int i = 0; i < 100000; ++i) {
    Ray ray = RandomRay(random, 8);
    // Every other ray at a vertex, where up to six triangles are hit at the same distance.
    if (i % 2 == 0) ray.d = mesh.P[static_cast<size_t>(random.Next() * mesh.P.size())] - ray.o;
    Hit a, b, c;
    const bool hit_a = one->Intersect(ray, &a), hit_b = two->Intersect(ray, &b),
               hit_c = again->Intersect(ray, &c);
    const auto same = [](const Hit& x, const Hit& y) {
      return x.t == y.t && x.u == y.u && x.v == y.v && x.shape == y.shape && x.primitive == y.primitive;
    };
    if (hit_a != hit_b || hit_a != hit_c || (hit_a && (!same(a, b) || !same(a, c)))) ++different;
  }
  EXPECT_EQ(different, 0);
}

TEST(Embree, RaysThatLeaveASurfaceDoNotFindItAgain) {
  TestRandom random(8);
  for (const float distance : {0.f, 30.f, 1000.f}) {
    Geometry geometry;
    geometry.shapes.push_back(BallMesh(10, {distance, distance / 3, 5}, 2));
    geometry.shapes.push_back(SphereShape({distance - 6, 0, 5}, 2));
    geometry.shapes.push_back(QuadricShape(Quadric::Kind::kSphere, RandomTransform(random, distance)));
    const Point3 corner{distance, -20, -20};
    geometry.shapes.push_back(
        PatchShape(corner, corner + Vec3{40, 1, 2}, corner + Vec3{1, 3, 40}, corner + Vec3{41, 4, 42}));
    geometry.groups.push_back({{BallMesh(10, {5, 1, 2}, 2), SphereShape({1, 0, 5}, 1)}});
    geometry.instances.push_back({0, RandomTransform(random, distance)});
    const TextureTable textures;
    const auto accelerator = Build(geometry, textures);
    int tried = 0, intersected = 0, occluded = 0;
    for (int i = 0; i < 200000; ++i) {
      const Ray ray{RandomPoint(random, distance + 10),
                    RandomPoint(random, 10) + Vec3{distance, distance / 3, 5}};
      Hit hit;
      if (!accelerator->Intersect({ray.o, ray.d - ray.o}, &hit)) continue;
      const SurfaceInteraction at = MakeInteraction(geometry, hit, {ray.o, ray.d - ray.o});
      // All these are convex: from the outside, no ray of the outer hemisphere meets the same one again.
      const Vec3 outward = FaceForward(RandomDirection(random), at.n);
      if (Dot(at.wo, at.n) <= 0) continue;
      ++tried;
      const Ray leaving = at.SpawnRay(outward);
      Hit again;
      if (accelerator->Intersect(leaving, &again) && again.shape == hit.shape &&
          again.instance == hit.instance)
        ++intersected;
      Ray nearby = leaving;
      nearby.t_max = 1e-3f * (1 + distance / 100);
      Hit close;
      const bool really = accelerator->Intersect(nearby, &close);
      if (accelerator->Occluded(nearby) && !really) ++occluded;
    }
    EXPECT_GT(tried, 1000) << distance;
    EXPECT_EQ(intersected, 0) << distance << " of " << tried;
    EXPECT_EQ(occluded, 0) << distance << " of " << tried;
  }
}

// Their normals, computed in single precision, have much larger errors than those of well-shaped ones.
TEST(Embree, ThinTrianglesDoNotOccludeRaysThatLeaveThem) {
  TestRandom random(12);
  const TextureTable textures;
  int false_hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Point3 a = RandomPoint(random, 10);
    const Vec3 along = RandomPoint(random, 10), across = RandomPoint(random, 0.01f);
    Geometry geometry{{i % 2 == 0 ? TriangleShape(a, a + along, a + along * 0.4f + across)
                                  : PatchShape(a, a + along, a + across, a + along + across)},
                      {},
                      {}};
    if (i % 4 < 2) {
      geometry.groups.push_back({std::move(geometry.shapes)});
      geometry.shapes.clear();
      geometry.instances.push_back({0, RandomTransform(random, 10)});
    }
    const auto accelerator = Build(geometry, textures);
    for (int j = 0; j < 200; ++j) {
      const Vec3 b = SampleUniformTriangle(Random2(random));
      Hit at;
      at.u = b.x;
      at.v = b.y;
      at.instance = geometry.instances.empty() ? Hit::kNoInstance : 0;
      const SurfaceInteraction start = MakeInteraction(geometry, at, {{}, RandomDirection(random)});
      const Ray leaving = start.SpawnRay(RandomDirection(random));
      Hit hit;
      false_hits += accelerator->Occluded(leaving) || accelerator->Intersect(leaving, &hit);
    }
  }
  EXPECT_EQ(false_hits, 0);
}

TEST(Embree, OpacityIsTheProbabilityOfAHit) {
  for (const bool is_patch : {false, true}) {
    Geometry geometry;
    geometry.shapes.push_back(is_patch ? PatchShape({-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1.2f})
                                       : TriangleShape({-3, -3, 1}, {3, -3, 1}, {0, 3, 1}));
    geometry.shapes[0].surface.alpha = {0.3f, -1};
    const TextureTable textures;
    const auto accelerator = Build(geometry, textures);
    TestRandom random(9);
    constexpr int kRays = 20000;
    int hits = 0;
    for (int i = 0; i < kRays; ++i) {
      const Point2 u = Random2(random);
      const Ray ray{{u.x - 0.5f, u.y - 0.5f, 0}, {0, 0, 1}};
      Hit hit;
      const bool found = accelerator->Intersect(ray, &hit);
      ASSERT_EQ(found, accelerator->Intersect(ray, &hit));
      ASSERT_EQ(found, accelerator->Occluded(ray));
      hits += found;
    }
    EXPECT_NEAR(hits / double{kRays}, 0.3, 4 * std::sqrt(0.3 * 0.7 / kRays));
  }
}

TEST(Embree, SurfacesWithoutOpacityAreNeverHit) {
  Geometry geometry{{SphereShape({0, 0, 5}, 1), TriangleShape({-3, -3, 1}, {3, -3, 1}, {0, 3, 1})}, {}, {}};
  for (Shape& shape : geometry.shapes) shape.surface.alpha = {0, -1};
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  Hit hit;
  EXPECT_FALSE(accelerator->Intersect({{0, 0, 0}, {0, 0, 1}}, &hit));
  EXPECT_FALSE(accelerator->Occluded({{0, 0, 0}, {0, 0, 1}}));
}

TEST(Embree, InterfacesAreHitButCastNoShadow) {
  Geometry geometry{{SphereShape({0, 0, 5}, 1), TriangleShape({-3, -3, 1}, {3, -3, 1}, {0, 3, 1})}, {}, {}};
  geometry.groups.push_back({geometry.shapes});
  for (Shape& shape : geometry.groups[0].shapes) shape.surface.is_interface = true;
  for (Shape& shape : geometry.shapes) shape.surface.is_interface = true;
  geometry.instances.push_back({0, Translate({10, 0, 0})});
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  for (const float x : {0.f, 10.f}) {
    Hit hit;
    EXPECT_TRUE(accelerator->Intersect({{x, 0, 0}, {0, 0, 1}}, &hit));
    EXPECT_EQ(hit.shape, 1u);
    EXPECT_TRUE(accelerator->Intersect({{x, 0, 2}, {0, 0, 1}}, &hit));
    EXPECT_EQ(hit.shape, 0u);
    EXPECT_FALSE(accelerator->Occluded({{x, 0, 0}, {0, 0, 1}}));
  }
}

TEST(Embree, AnEmptySceneHitsNothing) {
  const Geometry geometry;
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  Hit hit;
  EXPECT_FALSE(accelerator->Intersect({{0, 0, 0}, {0, 0, 1}}, &hit));
  EXPECT_FALSE(accelerator->Occluded({{0, 0, 0}, {0, 0, 1}}));
}

TEST(Accelerator, EmbreeIsTheDefault) {
  EXPECT_EQ(Accelerators().kinds().front().name, "embree");
}

TEST(Accelerator, EmbreeReportsItsMemory) {
  const Geometry geometry{{BallMesh(60, {}, 1)}, {}, {}};
  const TextureTable textures;
  const auto made = MakeAccelerator(*Accelerators().Find("embree"), geometry, textures);
  ASSERT_TRUE(made.has_value());
  EXPECT_GT((*made)->statistics().bytes, 100000u);
}

TEST(Embree, ManySmallObjectsThatMoveTakeLittleMemory) {
  constexpr int kCount = 2000;
  TestRandom random(7);
  Geometry geometry;
  geometry.times = {0, 1};
  for (int i = 0; i < kCount; ++i) {
    const Transform place = Translate(RandomPoint(random, 100));
    const AnimatedTransform motion({{0, place}, {1, Translate({1, 2, 3}) * place}});
    geometry.groups.push_back(
        {{QuadricShape(Quadric::Kind::kSphere, Transform(), 0.7f, -0.7f, 0.7f, 2 * kPi, 0)}});
    geometry.instances.push_back({i, Transform(), i});
    geometry.motions.emplace_back(std::span(&motion, 1));
  }
  const TextureTable textures;
  const auto accelerator = Build(geometry, textures);
  EXPECT_LT(accelerator->statistics().bytes, uint64_t{200} * kCount);
  Ray ray;
  ray.o = {0, 0, -500};
  int hits = 0;
  for (int i = 0; i < kCount; ++i) {
    ray.d = geometry.motions[static_cast<size_t>(i)].At(0).ToPoint({0, 0, 0}) - ray.o;
    Hit hit;
    if (accelerator->Intersect(ray, &hit)) hits += hit.instance == static_cast<uint32_t>(i);
  }
  EXPECT_GT(hits, kCount * 9 / 10);
}

}  // namespace
}  // namespace tessera
