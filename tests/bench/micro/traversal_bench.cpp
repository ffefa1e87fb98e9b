// Rays against a mesh by every accelerator: closest hits and occlusion, of rays in all directions and of rays
// of neighbouring pixels.
#include <memory>

#include "renderer/accelerator/accelerator.h"
#include "tests/bench/micro/micro_bench.h"
#include "tests/renderer/shape/example_shapes.h"

namespace tessera {
namespace {

constexpr int kRings = 100;  // some 40,000 triangles
constexpr size_t kRays = 4096;

// Owns what the accelerator refers to.
struct TracedScene {
  Geometry geometry;
  TextureTable textures;
  std::unique_ptr<Accelerator> accelerator;
};

// Chords of the ball that start inside it: every ray hits.
std::vector<Ray> IncoherentRays() {
  TestRandom random(1);
  std::vector<Ray> rays;
  for (size_t i = 0; i < kRays; ++i) {
    const Point3 o = RandomPoint(random, 0.5f);
    rays.push_back({o, Normalize(RandomPoint(random, 1)), INFINITY, 0});
  }
  return rays;
}

// Of a camera in front of the ball, row by row.
std::vector<Ray> CoherentRays() {
  constexpr int kSide = 64;
  std::vector<Ray> rays;
  for (size_t i = 0; i < kRays; ++i) {
    const float x = (static_cast<float>(i % kSide) + 0.5f) / kSide - 0.5f;
    const float y = (static_cast<float>(i / kSide) + 0.5f) / kSide - 0.5f;
    rays.push_back({{0, 0, -4}, Normalize(Vec3{0.4f * x, 0.4f * y, 1}), INFINITY, 0});
  }
  return rays;
}

void AddRays(const std::string& suffix, const std::shared_ptr<const TracedScene>& scene,
             const std::vector<Ray>& rays) {
  AddBenchmark("traversal/closest_hit/" + suffix, [scene, rays](size_t i) {
    Hit hit;
    return scene->accelerator->Intersect(rays[i % kRays], &hit) ? hit.t : 0;
  });
  AddBenchmark("traversal/occlusion/" + suffix,
               [scene, rays](size_t i) { return scene->accelerator->Occluded(rays[i % kRays]); });
}

void AddAccelerator(const Kind<AcceleratorMaker>& kind) {
  const std::string name(kind.name);
  const auto scene = std::make_shared<TracedScene>();
  scene->geometry.shapes.push_back(BallMesh(kRings, {0, 0, 0}, 1));
  auto made = MakeAccelerator(kind, scene->geometry, scene->textures);
  if (!made) return AddFailure("traversal/" + name, made.error().message);
  scene->accelerator = std::move(*made);
  AddRays("all_directions/" + name, scene, IncoherentRays());
  AddRays("neighbouring_pixels/" + name, scene, CoherentRays());
}

}  // namespace

void AddTraversalBenchmarks() {
  for (const Kind<AcceleratorMaker>& kind : Accelerators().kinds()) AddAccelerator(kind);
}

}  // namespace tessera
