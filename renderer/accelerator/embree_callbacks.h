// What Embree calls back while it traces: our own primitives, and alpha.
#pragma once

#include <cmath>
#include <span>

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

// Embree aborts at rays with coordinates of more than 1.8e18, whose squares are not finite.
constexpr float kTracedCoordinateMax = 1e18f;

// Whether the ray has numbers, and none of them too large. Embree must not be given any other.
inline bool IsTraceable(const RTCRay& ray, float origin_max) {
  return std::abs(ray.org_x) + std::abs(ray.org_y) + std::abs(ray.org_z) <= origin_max &&
         std::abs(ray.dir_x) + std::abs(ray.dir_y) + std::abs(ray.dir_z) <= kTracedCoordinateMax &&
         ray.tfar > 0;
}

void SetUserPrimitiveCallbacks(RTCGeometry geometry);
// Searches the primitives of records that Embree has no scene of, as it would. `ray_hit` and `ray` are in the
// space of the instance that the ray's context names.
void TryUserPrimitives(std::span<const EmbreeGeometryRecord> records, RTCIntersectContext* context,
                       RTCRayHit* ray_hit);
void TryUserPrimitives(std::span<const EmbreeGeometryRecord> records, RTCIntersectContext* context,
                       RTCRay* ray);
void SetAlphaFilter(RTCGeometry geometry);
// Keeps the surface that a shadow ray starts on from occluding it by a rounding error: thin triangles have
// inexact normals.
void SetOcclusionFilter(RTCGeometry geometry);

}  // namespace tessera
