// Owns an Embree device: its instruction set, threads, errors and memory.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

#include "renderer/util/load_budget.h"
#include "renderer/util/result.h"

namespace tessera {

template <typename Handle, void (*kRelease)(Handle)>
struct EmbreeRelease {
  void operator()(std::remove_pointer_t<Handle>* handle) const { kRelease(handle); }
};
using EmbreeSceneHandle =
    std::unique_ptr<std::remove_pointer_t<RTCScene>, EmbreeRelease<RTCScene, rtcReleaseScene>>;
using EmbreeGeometryHandle =
    std::unique_ptr<std::remove_pointer_t<RTCGeometry>, EmbreeRelease<RTCGeometry, rtcReleaseGeometry>>;

class EmbreeDevice {
 public:
  // Always for AVX2, even if the processor supports more: the bits of a hit depend on it. Uses `threads`
  // threads (at least 1) to build, none to trace.
  static Result<std::unique_ptr<EmbreeDevice>> Make(int threads);
  ~EmbreeDevice();
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice handle() const { return device_; }
  uint64_t bytes() const { return static_cast<uint64_t>(bytes_.load()); }
  // Building has ended: what is allocated or freed later does not concern the budget of the thread that made
  // the device.
  void EndBuild() { budget_ = nullptr; }
  // The first error since the device was created, if any. Only for the thread that builds.
  Result<void> Status() const;

 private:
  EmbreeDevice() = default;
  static void OnError(void* self, RTCError code, const char* text);
  static bool OnMemory(void* self, ssize_t bytes, bool post);

  RTCDevice device_ = nullptr;
  LoadBudget* budget_ = nullptr;
  std::atomic<int64_t> bytes_{0};
  std::string error_;
};

}  // namespace tessera
