// Triangle meshes that are refined and moved along their normals, as pbrt-v4's `plymesh` does for
// `displacement`.
#pragma once

#include <functional>

#include "renderer/description/mesh_data.h"
#include "renderer/math/transform.h"
#include "renderer/util/result.h"

namespace tessera {

struct Displacement {
  float edge_length = 1;  // no edge is longer, in rendering space
  Transform render_from_object;
  // How far a vertex moves along its unit normal, in object space. Arguments: its place in object space, its
  // normal and its texture coordinates.
  std::function<float(Point3, Normal3, Point2)> height;
};

// `mesh` has P, uv, perhaps N, and indices of triangles, all in range. An edge is split in both of the
// triangles that share it, so that the result has no cracks where the input has none. Normals are those of
// the moved surface. Edges of the resolution of floats are not split. An error, without a place, if there
// would be more than kMadeTrianglesMax triangles, before any is made if the area of the mesh shows it.
Result<MeshData> Displace(MeshData mesh, const Displacement& displacement);

}  // namespace tessera
