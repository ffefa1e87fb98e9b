// The three accelerators find the same hits.
#include <gtest/gtest.h>

#include <bit>
#include <tuple>

#include "renderer/accelerator/accelerator.h"
#include "renderer/accelerator/bvh_builder.h"
#include "tests/renderer/accelerator/agreement_scenes.h"

namespace tessera {
namespace {

// A million rays into each scene, in parts that may run side by side.
constexpr int kParts = 4, kRaysPerPart = 250000;

// Whether the ray goes through a vertex: each accelerator may hit or miss the primitives with a corner there.
bool IsAtVertex(int kind) {
  return kind % 4 == 1;
}

// Into the scene from outside or inside; some along axes, some at vertices, some short.
Ray FuzzedRay(TestRandom& random, const std::vector<Point3>& vertices, int kind) {
  Ray ray;
  ray.o = RandomPoint(random, 12);
  const bool at_vertex = IsAtVertex(kind) && !vertices.empty();
  const Point3 target =
      at_vertex ? vertices[static_cast<size_t>(random.Next() * static_cast<float>(vertices.size()))]
                : RandomPoint(random, 7);
  ray.d = target - ray.o;
  if (kind % 16 == 2) ray.d[kind / 16 % 3] = 0;
  if (kind % 16 == 3) ray.d = kind / 16 % 2 == 0 ? Vec3{0, 0, 3} : Vec3{-0.0f, -2, 0};
  if (kind % 16 == 6) ray.o = target + ray.d * 1e-4f;
  if (kind % 16 == 7) ray.o = ray.o * 1000;
  if (kind % 8 == 4) ray.t_max = 1.5f * random.Next();
  ray.time = kind % 16 == 5 ? 2 : 1 + 2 * random.Next();  // of a moving scene
  return ray;
}

std::vector<Point3> VerticesOf(const Geometry& geometry) {
  std::vector<Point3> vertices;
  for (const Shape& shape : geometry.shapes) {
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form)) {
      vertices.insert(vertices.end(), mesh->P.begin(), mesh->P.end());
    } else if (const auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
      vertices.insert(vertices.end(), patches->P.begin(), patches->P.end());
    }
  }
  return vertices;
}

struct Answer {
  bool hit = false, occluded = false;
  Hit at;
};
Answer Ask(const Accelerator& accelerator, const Ray& ray) {
  Answer answer;
  answer.hit = accelerator.Intersect(ray, &answer.at);
  answer.occluded = accelerator.Occluded(ray);
  return answer;
}

bool SameBits(const Answer& a, const Answer& b) {
  if (a.hit != b.hit || a.occluded != b.occluded) return false;
  if (!a.hit) return true;
  const auto bits = [](float f) { return std::bit_cast<uint32_t>(f); };
  return bits(a.at.t) == bits(b.at.t) && bits(a.at.u) == bits(b.at.u) && bits(a.at.v) == bits(b.at.v) &&
         a.at.shape == b.at.shape && a.at.primitive == b.at.primitive && a.at.instance == b.at.instance;
}

bool SamePrimitive(const Hit& a, const Hit& b) {
  return a.shape == b.shape && a.primitive == b.primitive && a.instance == b.instance;
}

struct Tally {
  int rays = 0, hits = 0, ties = 0, at_edges = 0, other_bits = 0, other_occlusion = 0;
};

// Ties are different primitives at the same distance within some rounding errors.
void CompareWithEmbree(const Answer& ours, const Answer& embree, Tally* tally) {
  ++tally->rays;
  tally->hits += ours.hit;
  tally->other_occlusion += ours.occluded != embree.occluded;
  if (ours.hit != embree.hit) {
    ++tally->at_edges;
  } else if (ours.hit && !SamePrimitive(ours.at, embree.at)) {
    const bool same_distance = std::abs(ours.at.t - embree.at.t) <= 2e-6f * embree.at.t;
    ++(same_distance ? tally->ties : tally->at_edges);
  } else if (ours.hit && !SameBits({true, true, ours.at}, {true, true, embree.at})) {
    ++tally->other_bits;
  }
}

void Print(const char* what, const Tally& tally) {
  std::printf("%s: %d rays, %d hits, %d ties, %d different at edges, %d other bits, %d other occlusions\n",
              what, tally.rays, tally.hits, tally.ties, tally.at_edges, tally.other_bits,
              tally.other_occlusion);
}

struct Trio {
  explicit Trio(const Geometry& geometry)
      : embree(*MakeAccelerator(*Accelerators().Find("embree"), geometry, textures)),
        bvh(*MakeAccelerator(*Accelerators().Find("bvh"), geometry, textures)),
        list(*MakeAccelerator(*Accelerators().Find("list"), geometry, textures)) {}

  TextureTable textures;
  std::unique_ptr<Accelerator> embree, bvh, list;
};

class Agreement : public testing::TestWithParam<std::tuple<Geometry (*)(), int>> {};

TEST_P(Agreement, AllAcceleratorsFindTheSameHits) {
  const auto [make_scene, part] = GetParam();
  const Geometry geometry = make_scene();
  const Trio trio(geometry);
  const std::vector<Point3> vertices = VerticesOf(geometry);
  TestRandom random(static_cast<uint64_t>(100 + part));
  Tally at_vertices, others;
  for (int i = 0; i < kRaysPerPart; ++i) {
    const Ray ray = FuzzedRay(random, vertices, i);
    const Answer of_bvh = Ask(*trio.bvh, ray);
    ASSERT_TRUE(SameBits(of_bvh, Ask(*trio.list, ray))) << i;
    ASSERT_TRUE(of_bvh.hit || !of_bvh.occluded) << i;
    CompareWithEmbree(of_bvh, Ask(*trio.embree, ray), IsAtVertex(i) ? &at_vertices : &others);
  }
  Print("at vertices", at_vertices);
  Print("others", others);
  EXPECT_GT(others.hits, others.rays / 4);
  EXPECT_LE(others.at_edges, 10);
  EXPECT_LE(others.other_occlusion, 10);
  EXPECT_EQ(others.other_bits + at_vertices.other_bits, 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Agreement,
                         testing::Combine(testing::Values(SoupScene, QuadricScene, PatchScene, CurveScene,
                                                          AlphaScene, InstanceScene, MovingScene),
                                          testing::Range(0, kParts)));

class OwnKind : public testing::TestWithParam<const char*> {};

TEST_P(OwnKind, AnyHitMeansOccluded) {
  TestRandom random(11);
  const Geometry geometry{Mixture(random), {}, {}};
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  const std::vector<Point3> vertices = VerticesOf(geometry);
  for (int i = 0; i < 20000; ++i) {
    Ray ray = FuzzedRay(random, vertices, i);
    Hit hit;
    const bool found = accelerator->Intersect(ray, &hit);
    ASSERT_EQ(accelerator->Occluded(ray), found);
    if (!found) continue;
    ASSERT_GT(hit.t, 0);
    ASSERT_LE(hit.t, ray.t_max);
    ray.t_max = hit.t * 0.999f;
    Hit nearer;
    ASSERT_FALSE(accelerator->Intersect(ray, &nearer));
  }
}

TEST_P(OwnKind, AClosedMeshLetsNoRayThrough) {
  const Geometry geometry{{BallMesh(12, {1000, 50, 3}, 10)}, {}, {}};
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  const auto& mesh = std::get<TriangleMesh>(geometry.shapes[0].form);
  TestRandom random(7);
  const Point3 inside{1002, 52, 4};
  Hit hit;
  for (int i = 0; i < 30000; ++i) {
    const auto [p0, p1, p2] =
        mesh.At(static_cast<uint32_t>(random.Next() * static_cast<float>(mesh.indices.size() / 3)));
    const Point3 target = i % 2 == 0 ? p0 : Lerp(random.Next(), p1, p2);
    const Ray outward{inside, target - inside};
    ASSERT_TRUE(accelerator->Intersect(outward, &hit)) << i;
    ASSERT_TRUE(accelerator->Occluded(outward)) << i;
    // From far away: positions are only good to some thousandths.
    const Point3 far = inside + Normalize(target - inside) * 1e4f;
    ASSERT_TRUE(accelerator->Intersect({far, inside - far}, &hit)) << i;
  }
}

TEST_P(OwnKind, RaysThatLeaveASurfaceDoNotFindItAgain) {
  TestRandom random(8);
  Geometry geometry;
  geometry.shapes.push_back(BallMesh(8, {30, 10, 5}, 2));
  geometry.shapes.push_back(SphereShape({24, 0, 5}, 2));
  geometry.groups.push_back({{BallMesh(8, {5, 1, 2}, 2), SphereShape({1, 0, 5}, 1)}});
  geometry.instances.push_back({0, RandomTransform(random, 30)});
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  int tried = 0, again = 0;
  for (int i = 0; i < 100000; ++i) {
    const Ray ray{RandomPoint(random, 40), {}};
    const Vec3 d = RandomPoint(random, 10) + Vec3{30, 10, 5} - ray.o;
    Hit hit;
    if (!accelerator->Intersect({ray.o, d}, &hit)) continue;
    const SurfaceInteraction at = MakeInteraction(geometry, hit, {ray.o, d});
    const Vec3 outward = FaceForward(RandomDirection(random), at.n);
    if (Dot(at.wo, at.n) <= 0) continue;
    ++tried;
    Hit next;
    again += accelerator->Intersect(at.SpawnRay(outward), &next) && next.shape == hit.shape &&
             next.instance == hit.instance;
  }
  EXPECT_GT(tried, 1000);
  EXPECT_EQ(again, 0);
}

TEST_P(OwnKind, InterfacesAreHitButCastNoShadow) {
  Geometry geometry{{SphereShape({0, 0, 5}, 1), TriangleShape({-3, -3, 1}, {3, -3, 1}, {0, 3, 1})}, {}, {}};
  for (Shape& shape : geometry.shapes) shape.surface.is_interface = true;
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  Hit hit;
  EXPECT_TRUE(accelerator->Intersect({{0, 0, 0}, {0, 0, 1}}, &hit));
  EXPECT_EQ(hit.shape, 1u);
  EXPECT_FALSE(accelerator->Occluded({{0, 0, 0}, {0, 0, 1}}));
}

TEST_P(OwnKind, AnEmptySceneHitsNothing) {
  Geometry geometry;
  geometry.groups.push_back({});
  geometry.instances.push_back({0, Transform()});
  const TextureTable textures;
  const auto accelerator = *MakeAccelerator(*Accelerators().Find(GetParam()), geometry, textures);
  Hit hit;
  EXPECT_FALSE(accelerator->Intersect({{0, 0, 0}, {0, 0, 1}}, &hit));
  EXPECT_FALSE(accelerator->Occluded({{0, 0, 0}, {0, 0, 1}}));
}

INSTANTIATE_TEST_SUITE_P(Kinds, OwnKind, testing::Values("bvh", "list"));

SearchSpace BuildTree(const std::vector<Shape>& shapes, int threads) {
  return *BuildBvhSpace(shapes, CollectPrimitives(shapes), threads);
}

TEST(Bvh, ThreadsDoNotChangeTheTree) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 6; ++i) {
    shapes.push_back(BallMesh(80, {static_cast<float>(i) * 0.9f - 5, 1, 2}, 1));
    shapes.push_back(SphereShape({static_cast<float>(i), 2, 2}, 1));
  }
  const SearchSpace one = BuildTree(shapes, 1), four = BuildTree(shapes, 4);
  EXPECT_GT(one.nodes.size(), 1000u);
  ASSERT_EQ(one.nodes.size(), four.nodes.size());
  ASSERT_EQ(one.blocks.size(), four.blocks.size());
  EXPECT_EQ(one.cost, four.cost);
  for (size_t i = 0; i < one.nodes.size(); ++i) {
    const BvhNode &a = one.nodes[i], &b = four.nodes[i];
    ASSERT_TRUE(std::equal(a.planes[0], a.planes[0] + 6 * BvhNode::kChildren, b.planes[0]));
    ASSERT_TRUE(std::equal(std::begin(a.child), std::end(a.child), std::begin(b.child)));
  }
  for (size_t i = 0; i < one.blocks.size(); ++i) {
    const TriangleBlock &a = one.blocks[i], &b = four.blocks[i];
    ASSERT_EQ(a.used, b.used);
    ASSERT_TRUE(std::equal(std::begin(a.shape), std::end(a.shape), std::begin(b.shape)));
    ASSERT_TRUE(std::equal(std::begin(a.primitive), std::end(a.primitive), std::begin(b.primitive)));
  }
}

TEST(Bvh, CoincidentPrimitivesStillMakeATree) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 200; ++i) {
    shapes.push_back(TriangleShape({0, 0, 1}, {1, 0, 1}, {0, 1, 1}));
    shapes.push_back(SphereShape({0, 0, 5}, 1));
  }
  const Geometry geometry{std::move(shapes), {}, {}};
  const Trio trio(geometry);
  const Ray ray{{0.2f, 0.2f, 0}, {0, 0, 1}};
  Hit hit;
  ASSERT_TRUE(trio.bvh->Intersect(ray, &hit));
  EXPECT_EQ(hit.shape, 0u);
  ASSERT_TRUE(trio.bvh->Intersect({{0.2f, 0.2f, 2}, {0, 0, 1}}, &hit));
  EXPECT_EQ(hit.shape, 1u);
}

TEST(Bvh, ReportsItsNodesMemoryAndCost) {
  const Geometry geometry{{BallMesh(60, {}, 1)}, {}, {}};
  const Trio trio(geometry);
  const AcceleratorStatistics of_bvh = trio.bvh->statistics(), of_list = trio.list->statistics();
  EXPECT_GT(of_bvh.nodes, 100u);
  EXPECT_GT(of_bvh.bytes, of_list.bytes);
  EXPECT_EQ(of_list.nodes, 0u);
  EXPECT_GT(of_bvh.sah_cost, 8);
  EXPECT_LT(of_bvh.sah_cost, of_list.sah_cost / 10);
}

}  // namespace
}  // namespace tessera
