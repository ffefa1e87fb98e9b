// Which surfaces of a world scatter light in the simplest way.
#pragma once

#include <vector>

#include "renderer/integrator/world.h"

namespace tessera {

// The surfaces of a world that are plain: triangles that are not instanced, do not emit, are hidden from
// nothing and scatter all light alike, without textures. Immutable.
class PlainSurfaces {
 public:
  struct Surface {
    const Spectrum* reflectance = nullptr;  // null if the surface is not plain
    // Of its TriangleMesh.
    const Point3* points = nullptr;
    const Normal3* normals = nullptr;  // the points if it has none
    const uint32_t* indices = nullptr;
    bool has_normals = false, flip_normals = false;
  };

  // `world` must outlive it and stay where it is.
  explicit PlainSurfaces(const World& world);

  // Whether there are any, and paths that meet them need nothing of their vertices but light.
  bool any() const { return any_; }
  const Surface& At(const Hit& hit) const {
    return hit.instance == Hit::kNoInstance ? surfaces_[hit.shape] : kOther;
  }

 private:
  static const Surface kOther;
  std::vector<Surface> surfaces_;  // by Geometry::shapes
  bool any_ = false;
};

}  // namespace tessera
