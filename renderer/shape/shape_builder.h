// From Shape directives to Geometry.
#pragma once

#include "language/file_source.h"
#include "language/scene_description.h"
#include "shape/geometry.h"
#include "texture/texture_builder.h"

namespace tessera {

// The form and alpha of one Shape directive, its vertices taken to rendering space by `render_from_world` after its own
// transform. Reads PLY files from `files`. The caller fills the rest of the surface properties.
// Not supported kinds and motion are errors that name them.
Result<Shape> BuildShape(const ShapeDescription& description, const Transform& render_from_world, FileSource& files,
                         TextureBuilder& textures);

}  // namespace tessera
