// Meshes from PLY files: ascii or binary of either byte order, any order and type of properties, optionally
// compressed by gzip. Files are not trusted: counts are checked against the size of the file before memory is
// allocated.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/math/vec.h"
#include "renderer/util/result.h"

namespace tessera {

struct PlyMesh {
  std::vector<Point3> P;
  std::vector<Normal3> N;           // as many as P, or none
  std::vector<Point2> uv;           // the same
  std::vector<uint32_t> triangles;  // three indices each
  std::vector<uint32_t> quads;      // four each, in the order of a patch: (0,0) (1,0) (0,1) (1,1)
  uint64_t skipped_faces = 0;       // of neither three nor four vertices
};

// `name` is the name of the file, for messages: "models/x.ply: truncated: vertex 17 of 1000 is cut off".
// Every index of the result is valid and every position finite.
Result<PlyMesh> ReadPly(std::string_view bytes, const std::string& name);

}  // namespace tessera
