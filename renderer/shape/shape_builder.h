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
// that can be ignored (normals of another length than P) are warnings with their place. The shape must not
// move.
Result<std::vector<Shape>> BuildShape(const ShapeDescription& description, SurfaceProperties surface,
                                      const Transform& render_from_world, FileSource& files,
                                      TextureBuilder& textures, Diagnostics& diagnostics);

}  // namespace tessera
