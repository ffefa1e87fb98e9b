// Shapes, transforms and rays for the tests of shapes and accelerators.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "renderer/math/sampling.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/hit_refinement.h"
#include "renderer/shape/ray_crossings.h"
#include "renderer/shape/shape_interaction.h"
#include "tests/chi_square.h"

namespace tessera {

constexpr auto kSphere = Quadric::Kind::kSphere;
constexpr auto kCylinder = Quadric::Kind::kCylinder;
constexpr auto kDisk = Quadric::Kind::kDisk;

inline Point2 Random2(TestRandom& random) {
  return random.Next2<Point2>();
}
inline Vec3 RandomDirection(TestRandom& random) {
  return SampleUniformSphere(Random2(random));
}
inline Point3 RandomPoint(TestRandom& random, float size) {
  const float x = random.Next(), y = random.Next(), z = random.Next();
  return {(2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size};
}

inline Shape MeshShape(std::vector<Point3> P, std::vector<uint32_t> indices) {
  TriangleMesh mesh;
  mesh.P = std::move(P);
  mesh.indices = std::move(indices);
  return {{}, std::move(mesh)};
}
inline Shape TriangleShape(Point3 a, Point3 b, Point3 c) {
  return MeshShape({a, b, c}, {0, 1, 2});
}
inline Shape PatchShape(Point3 p00, Point3 p10, Point3 p01, Point3 p11) {
  BilinearMesh mesh;
  mesh.P = {p00, p10, p01, p11};
  mesh.indices = {0, 1, 2, 3};
  return {{}, std::move(mesh)};
}
inline Shape QuadricShape(Quadric::Kind kind, const Transform& transform, float radius = 1, float z_min = -1,
                          float z_max = 1, float phi_max = 2 * kPi, float inner_radius = 0) {
  Quadric quadric;
  quadric.kind = kind;
  quadric.render_from_object = transform;
  quadric.radius = radius;
  quadric.z_min = z_min;
  quadric.z_max = kind == Quadric::Kind::kDisk ? z_min : z_max;
  quadric.phi_max = phi_max;
  quadric.inner_radius = inner_radius;
  quadric.flip_normals = transform.SwapsHandedness();
  return {{}, quadric};
}
inline Shape SphereShape(Point3 center, float radius) {
  return QuadricShape(Quadric::Kind::kSphere, Translate(center), radius, -radius, radius);
}

// Translation, rotation and scale with factors in [0.5, 2].
inline Transform RandomTransform(TestRandom& random, float distance) {
  const Vec3 delta = RandomPoint(random, distance);
  const float degrees = 360 * random.Next();
  const Vec3 axis = RandomDirection(random);
  const float x = 0.5f + 1.5f * random.Next(), y = 0.5f + 1.5f * random.Next(),
              z = 0.5f + 1.5f * random.Next();
  return Translate(delta) * Rotate(degrees, axis) * Scale(x, y, z);
}

// A closed ball of `rings` x `2 rings` quads cut in triangles, vertices shared.
inline Shape BallMesh(int rings, Point3 center, float radius) {
  std::vector<Point3> P;
  std::vector<uint32_t> indices;
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      const float theta = kPi * i / rings, phi = 2 * kPi * j / columns;
      const float r = i == 0 || i == rings ? 0 : std::sin(theta);
      P.push_back(center + Vec3{r * std::cos(phi), r * std::sin(phi), std::cos(theta)} * radius);
    }
  }
  // The poles are one vertex each.
  const auto vertex = [&](int i, int j) {
    return static_cast<uint32_t>(i == 0 || i == rings ? i * columns : i * columns + j % columns);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      if (b != c) indices.insert(indices.end(), {a, b, c});
      if (a != d) indices.insert(indices.end(), {a, c, d});
    }
  }
  return MeshShape(std::move(P), std::move(indices));
}

// The nearest crossing with one primitive beyond t_min, in double precision; a negative t if there is none.
inline Hit IntersectPrimitive(const Shape& shape, uint32_t primitive, DoubleRay ray, double t_min) {
  Hit hit;
  hit.primitive = primitive;
  hit.t = -1;
  ray.o = ray.At(t_min);
  Crossing crossing;
  if (!NearestCrossing(shape, primitive, ray, std::numeric_limits<double>::infinity(), &crossing)) return hit;
  hit.t = static_cast<float>(crossing.t + t_min);
  hit.u = crossing.u;
  hit.v = crossing.v;
  return hit;
}

// The nearest hit among all primitives of all shapes, one by one; no instances.
inline bool BruteForceIntersect(const Geometry& geometry, const Ray& ray, Hit* nearest) {
  const DoubleRay exact{Double3(ray.o), Double3(ray.d)};
  nearest->t = ray.t_max;
  bool found = false;
  for (uint32_t s = 0; s < geometry.shapes.size(); ++s) {
    for (uint32_t i = 0; i < geometry.shapes[s].PrimitiveCount(); ++i) {
      Hit hit = IntersectPrimitive(geometry.shapes[s], i, exact, 0);
      if (hit.t <= 0 || hit.t > nearest->t) continue;
      hit.shape = s;
      *nearest = hit;
      found = true;
    }
  }
  return found;
}

}  // namespace tessera
