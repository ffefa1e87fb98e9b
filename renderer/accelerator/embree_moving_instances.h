// Instances that move, which Embree searches through callbacks: its own would not move by the same bits as
// the other accelerators'.
#pragma once

#include <vector>

#include "renderer/accelerator/embree_callbacks.h"

namespace tessera {

struct EmbreeMovingInstance {
  uint32_t instance = 0;  // index in Geometry::instances
  const EmbreeScene* group = nullptr;
  Bounds3 bounds;  // at all times
};

// All moving instances of a scene: one geometry of Embree, whose primitives they are. Must stay where it is
// while that geometry exists.
struct EmbreeMovingInstances {
  std::vector<EmbreeMovingInstance> instances;
  // Of the first, as hits name it: instances are numbered on from the geometries of the scene.
  unsigned first_id = 0;

  // Makes `geometry`, of type RTC_GEOMETRY_TYPE_USER, these instances.
  void Set(RTCGeometry geometry);
};

}  // namespace tessera
