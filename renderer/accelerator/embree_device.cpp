#include "renderer/accelerator/embree_device.h"

#include <fmt/format.h>

namespace tessera {

Result<std::unique_ptr<EmbreeDevice>> EmbreeDevice::Make(int threads) {
  std::unique_ptr<EmbreeDevice> device(new EmbreeDevice);
  device->budget_ = LoadBudget::Current();
  const std::string settings = fmt::format("isa=avx2,threads={}", threads);
  device->device_ = rtcNewDevice(settings.c_str());
  if (!device->device_) {
    return Failed(fmt::format("Embree cannot start: error {}", static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  if (!rtcGetDeviceProperty(device->device_, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) ||
      !rtcGetDeviceProperty(device->device_, RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED)) {
    return Failed("this Embree was built without ray masks or filter functions");
  }
  rtcSetDeviceErrorFunction(device->device_, OnError, device.get());
  rtcSetDeviceMemoryMonitorFunction(device->device_, OnMemory, device.get());
  return device;
}

EmbreeDevice::~EmbreeDevice() {
  if (device_) rtcReleaseDevice(device_);
}

Result<void> EmbreeDevice::Status() const {
  if (error_.empty()) return {};
  return Failed(error_);
}

void EmbreeDevice::OnError(void* self, RTCError code, const char* text) {
  std::string& error = static_cast<EmbreeDevice*>(self)->error_;
  if (error.empty()) error = fmt::format("Embree: error {}: {}", static_cast<int>(code), text ? text : "");
}

bool EmbreeDevice::OnMemory(void* self, ssize_t bytes, bool) {
  auto* const device = static_cast<EmbreeDevice*>(self);
  if (device->budget_ != nullptr && !device->budget_->Charge(bytes)) return false;
  device->bytes_ += bytes;
  return true;
}

}  // namespace tessera
