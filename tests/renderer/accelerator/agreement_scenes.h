// Scenes on which the accelerators must agree.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "tests/renderer/shape/curve_examples.h"

namespace tessera {

inline std::vector<Shape> Soup(TestRandom& random) {
  std::vector<Shape> shapes;
  std::vector<Point3> P;
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < 120; ++i) {
    const Point3 center = RandomPoint(random, 5);
    for (int j = 0; j < 3; ++j) P.push_back(center + RandomPoint(random, i % 10 == 0 ? 6 : 1));
    indices.insert(indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  // Some are there twice: all their hits are ties.
  for (uint32_t i = 0; i < 30; ++i) indices.push_back(indices[i]);
  shapes.push_back(MeshShape(std::move(P), std::move(indices)));
  shapes.push_back(BallMesh(6, {2, 1, 0}, 1.5f));
  shapes.push_back(shapes.back());
  return shapes;
}

inline std::vector<Shape> Quadrics(TestRandom& random) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 60; ++i) {
    const auto kind = static_cast<Quadric::Kind>(i % 3);
    const bool whole = i % 2 == 0;
    shapes.push_back(QuadricShape(kind, RandomTransform(random, 5), 0.7f, whole ? -0.7f : -0.4f,
                                  whole ? 0.7f : 0.5f, whole ? 2 * kPi : 4.f, whole ? 0 : 0.2f));
  }
  return shapes;
}

inline std::vector<Shape> Patches(TestRandom& random) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 60; ++i) {
    const Point3 a = RandomPoint(random, 5), u = RandomPoint(random, 2), v = RandomPoint(random, 2);
    const Vec3 twist = i % 2 == 0 ? Vec3{} : RandomPoint(random, 0.7f);
    shapes.push_back(PatchShape(a, a + u, a + v, a + u + v + twist));
  }
  // A box, whose faces lie in planes of constant coordinates.
  shapes.push_back(PatchShape({-6, -6, -6}, {6, -6, -6}, {-6, 6, -6}, {6, 6, -6}));
  shapes.push_back(PatchShape({-6, -6, -6}, {6, -6, -6}, {-6, -6, 6}, {6, -6, 6}));
  return shapes;
}

// Curves of all kinds, some in a space of their own.
inline std::vector<Shape> Curves(TestRandom& random) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 72; ++i) {
    const Point3 center = RandomPoint(random, 4);
    CurveSet curves = RandomCurve(random, i, center, 2.5f, 1);
    if (i % 5 == 4) curves.render_from_object = std::make_shared<const Transform>(RandomTransform(random, 2));
    shapes.push_back({{}, std::move(curves)});
  }
  return shapes;
}

inline Geometry SoupScene() {
  TestRandom random(1);
  return {Soup(random), {}, {}};
}
inline Geometry QuadricScene() {
  TestRandom random(2);
  return {Quadrics(random), {}, {}};
}
inline Geometry PatchScene() {
  TestRandom random(3);
  return {Patches(random), {}, {}};
}
inline Geometry CurveScene() {
  TestRandom random(6);
  return {Curves(random), {}, {}};
}

// Shapes of every kind.
inline std::vector<Shape> Mixture(TestRandom& random) {
  std::vector<Shape> shapes = Soup(random);
  for (Shape& shape : Quadrics(random)) shapes.push_back(std::move(shape));
  for (Shape& shape : Patches(random)) shapes.push_back(std::move(shape));
  for (Shape& shape : Curves(random)) shapes.push_back(std::move(shape));
  return shapes;
}

inline Geometry AlphaScene() {
  TestRandom random(4);
  Geometry geometry{Mixture(random), {}, {}};
  int i = 0;
  for (Shape& shape : geometry.shapes) {
    ++i;
    if (i % 3 == 0) shape.surface.alpha = {0.25f * static_cast<float>(i % 4), -1};
    shape.surface.is_interface = i % 7 == 0;
  }
  return geometry;
}

inline Geometry InstanceScene() {
  TestRandom random(5);
  Geometry geometry;
  geometry.groups.push_back({Soup(random)});
  geometry.groups.push_back({Quadrics(random)});
  geometry.groups.push_back({});  // an empty group may be instanced
  geometry.groups.push_back({Patches(random)});
  geometry.groups.push_back({Curves(random)});
  for (int i = 0; i < 10; ++i) geometry.instances.push_back({i % 5, RandomTransform(random, 8)});
  geometry.instances.push_back(geometry.instances[0]);  // twice in the same place
  geometry.shapes.push_back(BallMesh(6, {2, 1, 0}, 1.5f));
  return geometry;
}

// Instances that rotate, scale and translate, some in two ways at the same time, beside static ones.
inline Geometry MovingScene() {
  TestRandom random(9);
  Geometry geometry = InstanceScene();
  geometry.times = {1, 3};
  for (int i = 0; i < 10; ++i) {
    const AnimatedTransform factors[] = {
        AnimatedTransform({{1, RandomTransform(random, 6)}, {1.5 + 0.1 * i, RandomTransform(random, 6)}}),
        i % 3 == 0 ? AnimatedTransform({{0, Transform()}, {4, Rotate(90, {0, 1, 0})}}) : AnimatedTransform()};
    geometry.instances.push_back({i % 5, Transform(), static_cast<int>(geometry.motions.size())});
    geometry.motions.emplace_back(factors);
  }
  // Flat for a moment.
  const AnimatedTransform mirrored({{1, Transform()}, {3, Scale(1, -1, 1)}});
  geometry.instances.push_back({0, Transform(), static_cast<int>(geometry.motions.size())});
  geometry.motions.emplace_back(std::span(&mirrored, 1));
  geometry.groups[4].shapes[3].surface.alpha = {0.5f, -1};
  // Small objects, for which no scene of Embree is made.
  const std::vector<Shape> quadrics = Quadrics(random);
  for (size_t i = 0; i < 8; ++i) {
    ShapeGroup group;
    for (size_t j = 0; j < 1 + i % 3; ++j) group.shapes.push_back(quadrics[3 * i + j]);
    group.shapes[0].surface.is_interface = i == 5;
    if (i % 4 == 3) group.shapes[0].surface.alpha = {0.5f, -1};
    const AnimatedTransform motion({{1, RandomTransform(random, 6)}, {2.5, RandomTransform(random, 6)}});
    geometry.instances.push_back(
        {static_cast<int>(geometry.groups.size()), Transform(), static_cast<int>(geometry.motions.size())});
    geometry.motions.emplace_back(std::span(&motion, 1));
    geometry.groups.push_back(std::move(group));
  }
  return geometry;
}

}  // namespace tessera
