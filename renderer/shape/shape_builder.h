// From Shape directives to Geometry.
#pragma once

#include "renderer/description/file_source.h"
#include "renderer/description/scene_description.h"
#include "renderer/shape/geometry.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

// The shapes of one Shape directive, with vertices taken to rendering space by `render_from_world` after the
// directive's own transform. `surface` holds their surface properties but for alpha, which the directive
// gives. Never empty: a PLY file of triangles and quads yields two. Reads PLY files from `files`. Wrong lists
// that can be ignored (normals of another length than P) are warnings with their place. A shape that moves
// stays in its own space.
Result<std::vector<Shape>> BuildShape(const ShapeDescription& description, SurfaceProperties surface,
                                      const Transform& render_from_world, FileSource& files,
                                      TextureBuilder& textures, Diagnostics& diagnostics);

// Stores the curves of `curves` with those of `shape` if they may be: curves of the same kind and surface. A
// scene has a directive for each hair, and a shape for each would cost a multiple of the memory and make
// slower accelerators. Returns false, and changes nothing, if they may not. Both must not emit.
bool MergeCurves(const Shape& curves, Shape* shape);

}  // namespace tessera
