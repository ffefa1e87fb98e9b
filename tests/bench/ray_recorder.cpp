#include "tests/bench/ray_recorder.h"

#include <dlfcn.h>

#include <bit>

#include "renderer/util/check.h"

namespace tessera {
namespace {

thread_local RayRecorder* t_recorder = nullptr;
thread_local bool t_is_inside = false;  // a recorded call

bool Records() {
  return t_recorder != nullptr && !t_recorder->is_paused() && !t_is_inside;
}

using Intersect1 = void (*)(RTCScene, RTCIntersectContext*, RTCRayHit*);
using Occluded1 = void (*)(RTCScene, RTCIntersectContext*, RTCRay*);

template <typename Function>
Function FromLibrary(const char* name) {
  void* const found = ::dlsym(RTLD_NEXT, name);
  TESSERA_CHECK(found != nullptr);
  return std::bit_cast<Function>(found);
}

// Initialised before main: no ray is traced earlier.
const auto kIntersect1 = FromLibrary<Intersect1>("rtcIntersect1");
const auto kOccluded1 = FromLibrary<Occluded1>("rtcOccluded1");

}  // namespace

RayRecorder::RayRecorder() {
  TESSERA_CHECK(t_recorder == nullptr);
  t_recorder = this;
}

RayRecorder::~RayRecorder() {
  t_recorder = nullptr;
}

void RayRecorder::Clear() {
  calls_.clear();
  occlusion_count_ = 0;
}

void RayRecorder::Add(RTCScene scene, const RTCIntersectContext* context, const RTCRay& query,
                      bool is_occlusion) {
  context_ = *reinterpret_cast<const EmbreeRayContext*>(context);
  calls_.push_back({scene, query, *context_.ray, is_occlusion});
  occlusion_count_ += is_occlusion ? 1 : 0;
}

void RayRecorder::AddResult(float tfar, unsigned primitive) {
  calls_.back().tfar = tfar;
  calls_.back().primitive = primitive;
}

uint64_t Replay(const RayRecorder& recorder) {
  uint64_t different = 0;
  EmbreeRayContext context = recorder.context_;
  for (const TracedCall& call : recorder.calls_) {
    rtcInitIntersectContext(&context.base);
    context.ray = &call.ray;
    context.ray_in_instance = nullptr;
    RTCRayHit query;
    query.ray = call.query;
    if (call.is_occlusion) {
      kOccluded1(call.scene, &context.base, &query.ray);
      different += query.ray.tfar != call.tfar ? 1 : 0;
    } else {
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.primID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      kIntersect1(call.scene, &context.base, &query);
      different += query.ray.tfar != call.tfar || query.hit.primID != call.primitive ? 1 : 0;
    }
  }
  return different;
}

}  // namespace tessera

// The program's own definitions come before those of the library.
extern "C" void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* query) {
  using namespace tessera;
  if (!Records()) return kIntersect1(scene, context, query);
  query->hit.primID = RTC_INVALID_GEOMETRY_ID;
  t_recorder->Add(scene, context, query->ray, false);
  t_is_inside = true;
  kIntersect1(scene, context, query);
  t_is_inside = false;
  t_recorder->AddResult(query->ray.tfar, query->hit.primID);
}

extern "C" void rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* query) {
  using namespace tessera;
  if (!Records()) return kOccluded1(scene, context, query);
  t_recorder->Add(scene, context, *query, true);
  t_is_inside = true;
  kOccluded1(scene, context, query);
  t_is_inside = false;
  t_recorder->AddResult(query->tfar, 0);
}
