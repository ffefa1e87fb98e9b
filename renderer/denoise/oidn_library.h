// Open Image Denoise, a library of Intel that denoises with neural networks, if it is on this machine. Loaded
// at run time, so that no program needs it. The functions are those of its C interface, in releases 1.4 to 2
// (its header OpenImageDenoise/oidn.h).
#pragma once

#include <cstddef>
#include <string>

#include "renderer/util/result.h"

namespace tessera::oidn {

struct Device;  // of the library
struct Filter;  // of the library

constexpr int kProcessor = 1;  // type of a device
constexpr int kFloat3 = 3;     // format of an image
constexpr int kNoError = 0, kCancelled = 6;

struct Functions {
  Device* (*new_device)(int type);
  void (*release_device)(Device* device);
  void (*set_device_bool)(Device* device, const char* name, bool value);
  void (*set_device_int)(Device* device, const char* name, int value);
  int (*get_device_int)(Device* device, const char* name);
  // Returns the first error since the last call, and its text. With a null device: of new_device.
  int (*get_device_error)(Device* device, const char** text);
  void (*commit_device)(Device* device);
  Filter* (*new_filter)(Device* device, const char* type);
  void (*release_filter)(Filter* filter);
  // Strides of 0 are those of values without gaps.
  void (*set_image)(Filter* filter, const char* name, void* values, int format, size_t width, size_t height,
                    size_t offset, size_t pixel_stride, size_t row_stride);
  void (*set_filter_bool)(Filter* filter, const char* name, bool value);
  // `monitor` returns whether to go on.
  void (*set_monitor)(Filter* filter, bool (*monitor)(void* user, double done), void* user);
  void (*commit_filter)(Filter* filter);
  void (*execute_filter)(Filter* filter);
};

struct Library {
  std::string file;  // that was loaded
  Functions functions{};
};

// Looks for libOpenImageDenoise.so.2, then .so.1, where dlopen looks for libraries. The first call that
// succeeds loads it for the rest of the process. The error says what to install. Thread safe.
Result<const Library*> Load();

// The library in this file.
Result<Library> LoadFrom(const std::string& file);

}  // namespace tessera::oidn
