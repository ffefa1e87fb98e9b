#include "renderer/denoise/oidn_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <mutex>
#include <optional>

#include "renderer/util/text.h"

namespace tessera::oidn {
namespace {

constexpr const char* kFiles[] = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1"};
constexpr const char* kRemedy =
    "install Open Image Denoise 1.4 or 2 (openimagedenoise.org) where the system finds libraries, or name "
    "its "
    "folder in LD_LIBRARY_PATH, or use --denoiser regression";

// Looks functions up until one is missing.
class FunctionFinder {
 public:
  explicit FunctionFinder(void* library) : library_(library) {}

  // `former` is what releases before 2 call the function, or null.
  template <typename Function>
  void Find(const char* name, const char* former, Function*& function) {
    void* found = ::dlsym(library_, name);
    if (found == nullptr && former != nullptr) found = ::dlsym(library_, former);
    if (found == nullptr && missing_ == nullptr) missing_ = name;
    function = reinterpret_cast<Function*>(found);
  }
  const char* missing() const { return missing_; }

 private:
  void* const library_;
  const char* missing_ = nullptr;
};

const char* FindAll(void* library, Functions& functions) {
  FunctionFinder finder(library);
  finder.Find("oidnNewDevice", nullptr, functions.new_device);
  finder.Find("oidnReleaseDevice", nullptr, functions.release_device);
  finder.Find("oidnSetDeviceBool", "oidnSetDevice1b", functions.set_device_bool);
  finder.Find("oidnSetDeviceInt", "oidnSetDevice1i", functions.set_device_int);
  finder.Find("oidnGetDeviceInt", "oidnGetDevice1i", functions.get_device_int);
  finder.Find("oidnGetDeviceError", nullptr, functions.get_device_error);
  finder.Find("oidnCommitDevice", nullptr, functions.commit_device);
  finder.Find("oidnNewFilter", nullptr, functions.new_filter);
  finder.Find("oidnReleaseFilter", nullptr, functions.release_filter);
  finder.Find("oidnSetSharedFilterImage", nullptr, functions.set_image);
  finder.Find("oidnSetFilterBool", "oidnSetFilter1b", functions.set_filter_bool);
  finder.Find("oidnSetFilterProgressMonitorFunction", nullptr, functions.set_monitor);
  finder.Find("oidnCommitFilter", nullptr, functions.commit_filter);
  finder.Find("oidnExecuteFilter", nullptr, functions.execute_filter);
  return finder.missing();
}

std::string LastError() {
  const char* const text = ::dlerror();
  return text == nullptr ? "unknown error" : OneLine(text);
}

}  // namespace

Result<Library> LoadFrom(const std::string& file) {
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    return Failed(fmt::format("Open Image Denoise cannot be loaded ({}); {}", LastError(), kRemedy));
  Library loaded{file};
  const char* const missing = FindAll(library, loaded.functions);
  if (missing == nullptr) return loaded;
  ::dlclose(library);
  return Failed(fmt::format("{}: lacks the function {} of Open Image Denoise; {}", file, missing, kRemedy));
}

Result<const Library*> Load() {
  static std::mutex mutex;
  static std::optional<Library> loaded;  // guarded by mutex
  const std::lock_guard lock(mutex);
  std::optional<Error> first;
  for (const char* file : kFiles) {
    if (loaded) break;
    auto library = LoadFrom(file);
    if (library) loaded = std::move(*library);
    if (!library && !first) first = library.error();
  }
  if (!loaded) return *first;
  return &*loaded;
}

}  // namespace tessera::oidn
