// From lists of vertices and indices, as scenes and files give them, to meshes in rendering space.
#pragma once

#include <string>
#include <vector>

#include "renderer/description/mesh_data.h"
#include "renderer/shape/geometry.h"

namespace tessera {

// How a shape comes to rendering space.
struct Placement {
  Transform render_from_object;
  bool reverse_orientation = false;

  bool FlipsNormals() const { return reverse_orientation != render_from_object.SwapsHandedness(); }
};

// Both leave room for one more vertex after P, where kernels that load four floats at a time may read.
TriangleMesh MakeTriangleMesh(MeshData lists, const Placement& placement);
BilinearMesh MakeBilinearMesh(MeshData lists, const Placement& placement);

// The same mesh without the vertices to which no index refers.
MeshData WithoutUnused(const MeshData& lists);

}  // namespace tessera
