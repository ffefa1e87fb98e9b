#include "renderer/formats/loader/module_loader.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>

#include "renderer/util/threads.h"

// Defined in programs that are linked with the objects of the module, null in others.
extern "C" __attribute__((weak)) const tessera::image_module::Functions* TesseraImageFormats();

namespace tessera::image_module {
namespace {

constexpr char kFileName[] = "libtessera_image_formats.so";
constexpr char kEntryName[] = "TesseraImageFormats";

// Libraries that OpenImageIO needs start threads while they are loaded, and end the process if they cannot.
// Those of Debian 12 start 4, and one loads them here.
constexpr int kThreadsMin = 8;

Error Unusable(const std::string& path, const std::string& why) {
  return Failed(fmt::format(
      "{}: the module for picture formats {}; install the files of one release of Tessera again", path, why));
}

Result<std::string> ModulePath() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return Failed(fmt::format("/proc/self/exe: cannot be read: {}", error.message()));
  return (program.parent_path() / kFileName).string();
}

Result<const Functions*> Open(const std::string& path) {
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return Unusable(path, fmt::format("cannot be loaded ({})", ::dlerror()));
  using Entry = decltype(TesseraImageFormats)*;
  const auto entry = reinterpret_cast<Entry>(::dlsym(library, kEntryName));
  if (entry == nullptr) return Unusable(path, fmt::format("lacks the function {}", kEntryName));
  const Functions* const functions = entry();
  if (functions->version != kVersion) {
    return Unusable(
        path, fmt::format("has version {}, this program needs version {}", functions->version, kVersion));
  }
  return functions;
}

}  // namespace

Result<const Functions*> LoadFrom(const std::string& path) {
  if (!path.starts_with('/')) return Unusable(path, "has no absolute path");
  if (::access(path.c_str(), R_OK) != 0)
    return Unusable(path, fmt::format("cannot be read ({})", std::strerror(errno)));
  if (auto can_start = CheckThreads(kThreadsMin); !can_start)
    return Failed(fmt::format("{}: {}", path, can_start.error().message));
  Result<const Functions*> functions = Failed("");
  ThreadGroup thread([&functions](Error error) { functions = std::move(error); });
  // On a thread of its own, because what the libraries allocate for themselves while they are loaded must not
  // be refused and is no part of the scene that this thread may be loading (LoadBudget).
  if (auto started = thread.Start([&] { functions = Open(path); }); !started) return started.error();
  thread.Join();
  return functions;
}

Result<const Functions*> Load() {
  if (TesseraImageFormats != nullptr) return TesseraImageFormats();
  static std::mutex mutex;
  static const Functions* loaded = nullptr;  // guarded by mutex
  const std::lock_guard lock(mutex);
  if (loaded != nullptr) return loaded;
  const auto path = ModulePath();
  if (!path) return path.error();
  const auto functions = LoadFrom(*path);
  if (functions) loaded = *functions;
  return functions;
}

Result<void> CheckInstalled() {
  if (TesseraImageFormats != nullptr) return {};
  const auto path = ModulePath();
  if (!path) return path.error();
  if (::access(path->c_str(), R_OK) == 0) return {};
  return Unusable(*path, fmt::format("cannot be read ({})", std::strerror(errno)));
}

Result<std::string> Encode(const RgbPicture& picture) {
  const auto functions = Load();
  if (!functions) return functions.error();
  EncodedFile file{};
  Reason reason{};
  if (!(*functions)->encode(picture, file, reason)) return Failed(reason.text);
  std::string bytes(static_cast<const char*>(file.bytes), file.size);
  (*functions)->release(file);
  return bytes;
}

}  // namespace tessera::image_module
