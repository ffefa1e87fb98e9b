// From Shape directives to Geometry.
#pragma once

#include "renderer/description/file_source.h"
#include "renderer/description/scene_description.h"
#include "renderer/shape/geometry.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

// The shapes of one Shape directive with their forms and alpha, vertices taken to rendering space by
// `render_from_world` after the directive's own transform. Never empty: a PLY file of triangles and quads
// yields two. Reads PLY files from `files`. The caller fills the rest of the surface properties and
// Shape::description. Parameters that are ignored because they are wrong (a list of normals whose length
// differs from P's) are warnings. The shape must not move.
Result<std::vector<Shape>> BuildShape(const ShapeDescription& description, const Transform& render_from_world,
                                      FileSource& files, TextureBuilder& textures, Diagnostics& diagnostics);

}  // namespace tessera
