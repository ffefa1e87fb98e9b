// Axis-aligned boxes, and spheres around things.
#pragma once

#include <limits>

#include "renderer/math/vec.h"

namespace tessera {

// A box of points; empty (min > max) until a point is added.
struct Bounds3 {
  Vec3 min{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
           std::numeric_limits<float>::infinity()};
  Vec3 max{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
           -std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  void Add(Point3 p) {
    min = Min(min, p);
    max = Max(max, p);
  }
  void Add(const Bounds3& b) {
    min = Min(min, b.min);
    max = Max(max, b.max);
  }
  Vec3 Diagonal() const { return max - min; }
  Point3 Center() const { return (min + max) * 0.5f; }
  float SurfaceArea() const {
    const Vec3 d = Diagonal();
    return 2 * (d.x * d.y + d.x * d.z + d.y * d.z);
  }
  bool Contains(Point3 p) const {
    return p.x >= min.x && p.x <= max.x && p.y >= min.y && p.y <= max.y && p.z >= min.z && p.z <= max.z;
  }
};

struct BoundingSphere {
  Point3 center;
  float radius = 0;
};

// The sphere through the corners of a box.
inline BoundingSphere SphereAround(const Bounds3& box) {
  return {box.Center(), Length(box.Diagonal()) / 2};
}

// The union of two boxes.
inline Bounds3 Union(Bounds3 a, const Bounds3& b) {
  a.Add(b);
  return a;
}

}  // namespace tessera
