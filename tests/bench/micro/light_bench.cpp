// Choosing one light of many by every light sampler.
#include <cmath>
#include <memory>

#include "renderer/light/light_chooser.h"
#include "tests/bench/micro/micro_bench.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

Vec3 InBox(TestRandom& random, float size) {
  const float x = random.Next();
  const float y = random.Next();
  const float z = random.Next();
  return {(x - 0.5f) * size, (y - 0.5f) * size, (z - 0.5f) * size};
}

// Small triangles that face anywhere in a room.
std::vector<LightProfile> Profiles(int count) {
  TestRandom random(1);
  std::vector<LightProfile> profiles;
  for (int i = 0; i < count; ++i) {
    LightBounds bounds;
    const Point3 center = InBox(random, 10);
    for (int corner = 0; corner < 3; ++corner) bounds.box.Add(center + InBox(random, 0.2f));
    bounds.axis = Normalize(InBox(random, 1));
    bounds.cos_theta_e = 0;
    bounds.strength = 0.1f + random.Next();
    profiles.push_back({.power = bounds.strength, .bounds = bounds});
  }
  return profiles;
}

std::vector<ReferencePoint> Points() {
  TestRandom random(2);
  std::vector<ReferencePoint> points;
  for (int i = 0; i < 1024; ++i) {
    ReferencePoint point;
    point.p = InBox(random, 10);
    point.n = point.shading_n = Normalize(InBox(random, 1));
    points.push_back(point);
  }
  return points;
}

void AddLightSampler(const Kind<LightSamplerKind>& kind, int count) {
  const auto chooser = std::make_shared<const LightChooser>(kind.reader, Profiles(count));
  const std::string name = std::string(kind.name) + "/" + std::to_string(count);
  AddBenchmark("light/choose/" + name, [chooser, points = Points(), numbers = NumberRing(3)](size_t i) {
    return chooser->Choose(points[i % points.size()], numbers.At(i));
  });
  AddBenchmark("light/probability/" + name, [chooser, points = Points(), count](size_t i) {
    return chooser->Pmf(points[i % points.size()], static_cast<int>(i * 7 % static_cast<size_t>(count)));
  });
}

}  // namespace

void AddLightBenchmarks() {
  for (const Kind<LightSamplerKind>& kind : LightSamplers().kinds()) {
    for (const int count : {2, 64, 4096}) AddLightSampler(kind, count);
  }
}

}  // namespace tessera
