// The kinds of shapes that scenes may name.
#pragma once

#include "renderer/description/kind_table.h"
#include "renderer/shape/shape_directive.h"

namespace tessera {

KindTable<ShapeReader> ShapeKinds();

}  // namespace tessera
