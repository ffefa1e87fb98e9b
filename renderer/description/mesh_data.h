// A mesh as lists of vertices and indices.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/math/vec.h"

namespace tessera {

// In object space. Lists other than P and the indices are empty or as long as P.
struct MeshData {
  std::vector<Point3> P;
  std::vector<Normal3> N;
  std::vector<Vec3> S;  // tangents
  std::vector<Point2> uv;
  std::vector<uint32_t> indices;  // into P: three per triangle, or four per bilinear patch
};

}  // namespace tessera
