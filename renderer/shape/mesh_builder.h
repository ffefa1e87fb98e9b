// From lists of vertices and indices, as scenes and files give them, to meshes in rendering space.
#pragma once

#include <string>
#include <vector>

#include "renderer/shape/geometry.h"

namespace tessera {

// In object space. Indices are valid; lists other than P are empty or as long as P.
struct MeshLists {
  std::vector<Point3> P;
  std::vector<Normal3> N;
  std::vector<Vec3> S;
  std::vector<Point2> uv;
  std::vector<uint32_t> indices;
};

// How a shape comes to rendering space.
struct Placement {
  Transform render_from_object;
  bool reverse_orientation = false;

  bool FlipsNormals() const { return reverse_orientation != render_from_object.SwapsHandedness(); }
};

// Both leave room for one more vertex after P, where kernels that load four floats at a time may read.
TriangleMesh MakeTriangleMesh(MeshLists lists, const Placement& placement);
BilinearMesh MakeBilinearMesh(MeshLists lists, const Placement& placement);

// The same mesh without the vertices to which no index refers.
MeshLists WithoutUnused(const MeshLists& lists);

}  // namespace tessera
