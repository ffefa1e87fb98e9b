// Records the rays that a render gives to Embree, and replays them without the rest of the renderer. Only for
// programs that link ray_recorder.cpp: it takes the place of rtcIntersect1 and rtcOccluded1 there, and calls
// those of the library.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "renderer/accelerator/embree_callbacks.h"
#include "renderer/math/ray.h"

namespace tessera {

// One call of Embree, with its result.
struct TracedCall {
  RTCScene scene = nullptr;
  RTCRay query;  // as it was given
  Ray ray;       // what the context of the call refers to
  bool is_occlusion = false;
  float tfar = 0;          // afterwards: the distance of the hit, or -inf if occluded
  unsigned primitive = 0;  // that was hit
};

// The calls of one thread. Those that callbacks of a recorded call make are part of it.
class RayRecorder {
 public:
  // Records the calls of the calling thread until it is destroyed. At most one exists on a thread.
  RayRecorder();
  ~RayRecorder();
  RayRecorder(const RayRecorder&) = delete;
  RayRecorder& operator=(const RayRecorder&) = delete;

  const std::vector<TracedCall>& calls() const { return calls_; }
  uint64_t occlusion_count() const { return occlusion_count_; }
  // Empties the list and keeps its memory.
  void Clear();
  // While it is paused the thread's calls are not recorded.
  void Pause(bool is_paused) { is_paused_ = is_paused; }
  bool is_paused() const { return is_paused_; }

  // Called by the functions in Embree's place.
  void Add(RTCScene scene, const RTCIntersectContext* context, const RTCRay& query, bool is_occlusion);
  void AddResult(float tfar, unsigned primitive);

 private:
  friend uint64_t Replay(const RayRecorder& recorder);
  std::vector<TracedCall> calls_;
  uint64_t occlusion_count_ = 0;
  bool is_paused_ = false;
  EmbreeRayContext context_{};  // of all calls, but for its ray
};

// Traces all recorded rays again with nothing else in between. The scenes must still exist. Returns the
// number of calls whose result differs.
uint64_t Replay(const RayRecorder& recorder);

}  // namespace tessera
