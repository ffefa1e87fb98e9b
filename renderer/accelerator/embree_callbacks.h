// What Embree calls back while it traces: our own primitives, and alpha.
#pragma once

#include "renderer/accelerator/embree_scene.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Passed with every ray.
struct EmbreeRayContext {
  RTCIntersectContext base;  // first: callbacks get a pointer to it
  const Ray* ray;            // in rendering space
  const Geometry* geometry;
  const TextureTable* textures;
  // Maps a geometry id at the top level, less first_instance, to an index in Geometry::instances.
  const uint32_t* instances;
  uint32_t first_instance;  // geometry id of the first instance
  // `ray` in the space of the moving instance that is searched; null outside of one.
  const DoubleRay* ray_in_instance = nullptr;

  uint32_t InstanceOf(uint32_t embree_instance) const {
    return embree_instance == RTC_INVALID_GEOMETRY_ID ? Hit::kNoInstance
                                                      : instances[embree_instance - first_instance];
  }
};

void SetUserPrimitiveCallbacks(RTCGeometry geometry);
void SetAlphaFilter(RTCGeometry geometry);
// Keeps the surface that a shadow ray starts on from occluding it by a rounding error: thin triangles have
// inexact normals.
void SetOcclusionFilter(RTCGeometry geometry);

}  // namespace tessera
