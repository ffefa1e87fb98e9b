// Loop's subdivision of triangle meshes (Loop 1987): each level cuts every triangle into four and moves the
// vertices; at the end they are moved to where they would be after infinitely many levels, with the normals
// of that surface.
#pragma once

#include "renderer/description/mesh_data.h"
#include "renderer/util/result.h"

namespace tessera {

// Reads P and indices, which are in range and a multiple of three. The result has P, N (not unit, on the back
// of triangles that are counterclockwise, as pbrt has them) and indices. An error, without a place, if a
// triangle has a point twice, if more than two triangles share an edge, if neighbours are oriented
// differently, or if there would be more than kMadeTrianglesMax triangles.
Result<MeshData> SubdivideLoop(const MeshData& control, int levels);

}  // namespace tessera
