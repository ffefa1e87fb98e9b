// A library with the interface of Open Image Denoise. Its filter checks that it was given all images and
// computes color / 2 + albedo + normal / 4. What differs between the variants is said by a definition:
//   NEW             as releases 2 are
//   FORMER          as releases 1.4 are, whose functions for parameters have other names
//   INCOMPLETE      a function is missing
//   NEXT_VERSION    a release whose interface is not known
//   WITHOUT_DEVICE  cannot work on this machine
//   FAILING         the filter fails, and leaves values that are not numbers
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#ifdef TESSERA_OIDN_FORMER
#define PARAMETER(now, former) former
#else
#define PARAMETER(now, former) now
#endif

namespace {

struct Image {
  float* values = nullptr;
  size_t count = 0;
};

struct State {
  int error = 0;
  const char* text = "";
  bool is_committed = false;
};

State& TheDevice() {
  static State device;
  return device;
}

void Fail(int error, const char* text) {
  TheDevice().error = error;
  TheDevice().text = text;
}

struct FilterState {
  Image color, albedo, normal, output;
  bool is_hdr = false;
  bool (*monitor)(void*, double) = nullptr;
  void* user = nullptr;
};

}  // namespace

extern "C" {

void* oidnNewDevice(int type) {
#ifdef TESSERA_OIDN_WITHOUT_DEVICE
  Fail(5, "the processor lacks\nwhat is needed");
  return nullptr;
#endif
  TheDevice() = {};
  if (type != 1) Fail(2, "not the processor");
  return &TheDevice();
}
void oidnReleaseDevice(void*) {}
void PARAMETER(oidnSetDeviceBool, oidnSetDevice1b)(void*, const char* name, bool) {
  if (std::strcmp(name, "setAffinity") != 0) Fail(2, name);
}
void PARAMETER(oidnSetDeviceInt, oidnSetDevice1i)(void*, const char* name, int value) {
  if (std::strcmp(name, "numThreads") != 0 || value < 1) Fail(2, name);
}
int PARAMETER(oidnGetDeviceInt, oidnGetDevice1i)(void*, const char* name) {
  if (std::strcmp(name, "version") != 0) Fail(2, name);
#if defined(TESSERA_OIDN_NEXT_VERSION)
  return 30000;
#elif defined(TESSERA_OIDN_FORMER)
  return 10403;
#else
  return 20303;
#endif
}
int oidnGetDeviceError(void*, const char** text) {
  const int error = TheDevice().error;
  *text = TheDevice().text;
  TheDevice().error = 0;
  return error;
}
void oidnCommitDevice(void*) {
  TheDevice().is_committed = true;
}
void* oidnNewFilter(void*, const char* type) {
  if (std::strcmp(type, "RT") == 0 && TheDevice().is_committed) return new FilterState;
  Fail(3, "no such filter");
  return nullptr;
}
void oidnReleaseFilter(void* filter) {
  delete static_cast<FilterState*>(filter);
}
void oidnSetSharedFilterImage(void* filter, const char* name, void* values, int format, size_t width,
                              size_t height, size_t offset, size_t pixel_stride, size_t row_stride) {
  if (format != 3 || offset + pixel_stride + row_stride != 0) return Fail(2, "not three floats");
  FilterState& state = *static_cast<FilterState*>(filter);
  for (const auto& [known, image] : {std::pair<const char*, Image*>{"color", &state.color},
                                     {"albedo", &state.albedo},
                                     {"normal", &state.normal},
                                     {"output", &state.output}}) {
    if (std::strcmp(name, known) == 0) *image = {static_cast<float*>(values), width * height * 3};
  }
}
void PARAMETER(oidnSetFilterBool, oidnSetFilter1b)(void* filter, const char* name, bool value) {
  if (std::strcmp(name, "hdr") == 0) static_cast<FilterState*>(filter)->is_hdr = value;
}
void oidnSetFilterProgressMonitorFunction(void* filter, bool (*monitor)(void*, double), void* user) {
  static_cast<FilterState*>(filter)->monitor = monitor;
  static_cast<FilterState*>(filter)->user = user;
}
void oidnCommitFilter(void* filter) {
  const FilterState& state = *static_cast<FilterState*>(filter);
  const bool has_all =
      state.color.values && state.albedo.values && state.normal.values && state.output.values;
  if (!has_all || !state.is_hdr) Fail(3, "an image or the flag hdr is missing");
}
#ifndef TESSERA_OIDN_INCOMPLETE
void oidnExecuteFilter(void* filter) {
  const FilterState& state = *static_cast<FilterState*>(filter);
  if (!state.monitor(state.user, 0.5)) return Fail(6, "cancelled");
  for (size_t i = 0; i < state.output.count; ++i)
    state.output.values[i] =
        0.5f * state.color.values[i] + state.albedo.values[i] + 0.25f * state.normal.values[i];
  state.output.values[0] = std::numeric_limits<float>::quiet_NaN();
#ifdef TESSERA_OIDN_FAILING
  Fail(4, "");
#endif
}
#endif

}  // extern "C"
