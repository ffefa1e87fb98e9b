#include "renderer/shape/shape_kinds.h"

namespace tessera {
namespace {

constexpr Kind<ShapeReader> kShapes[] = {
    {"sphere", Support::kSupported, ReadSphere},     {"disk", Support::kSupported, ReadDisk},
    {"cylinder", Support::kSupported, ReadCylinder}, {"trianglemesh", Support::kSupported, ReadTriangleMesh},
    {"plymesh", Support::kSupported, ReadPlyMesh},   {"bilinearmesh", Support::kSupported, ReadBilinearMesh},
    {"curve", Support::kSupported, ReadCurve},       {"loopsubdiv", Support::kSupported, ReadLoopSubdivision},
};

}  // namespace

KindTable<ShapeReader> ShapeKinds() {
  return {"shape", kShapes};
}

}  // namespace tessera
