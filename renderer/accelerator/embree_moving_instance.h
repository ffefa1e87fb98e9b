// Instances that move, which Embree searches through callbacks: its own would not move by the same bits as
// the other accelerators'.
#pragma once

#include "renderer/accelerator/embree_callbacks.h"

namespace tessera {

// The source of one Embree geometry. Must stay where it is while the geometry exists.
struct EmbreeMovingInstance {
  uint32_t instance = 0;  // index in Geometry::instances
  unsigned geometry_id = 0;
  RTCScene group = nullptr;
  Bounds3 bounds;  // at all times
};

// Makes `geometry`, of type RTC_GEOMETRY_TYPE_USER, the instance.
void SetMovingInstance(RTCGeometry geometry, EmbreeMovingInstance* instance);

}  // namespace tessera
