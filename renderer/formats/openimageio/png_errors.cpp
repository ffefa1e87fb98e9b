// Keeps libpng from printing a line for each damaged picture. OpenImageIO's error handler returns, and libpng
// then prints the error to stderr before it jumps out of the function that failed. This module comes before
// libpng in the search for symbols, so OpenImageIO calls the function below in place of libpng's, and gets a
// handler that jumps by itself. Programs that have OpenImageIO linked in are as they were.
#include <dlfcn.h>

#include <atomic>

// As libpng's manual declares them.
struct png_struct_def;
using PngErrorHandler = void (*)(png_struct_def*, const char* message);

namespace tessera::image_module {
namespace {

using SetHandlers = void (*)(png_struct_def*, void* owner, PngErrorHandler error, PngErrorHandler warning);
using LongJump = void (*)(png_struct_def*, int value);

// That of OpenImageIO, which is the same for all pictures that it reads.
std::atomic<PngErrorHandler> reader_handler{nullptr};

template <typename Function>
Function Original(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

void HandleError(png_struct_def* png, const char* message) {
  reader_handler.load()(png, message);
  static const auto jump = Original<LongJump>("png_longjmp");
  if (jump != nullptr) jump(png, 1);
}

// False for a second handler, whose errors are printed.
bool Remember(PngErrorHandler handler) {
  PngErrorHandler known = nullptr;
  return handler != nullptr && (reader_handler.compare_exchange_strong(known, handler) || known == handler);
}

}  // namespace
}  // namespace tessera::image_module

extern "C" __attribute__((visibility("default"))) void png_set_error_fn(png_struct_def* png, void* owner,
                                                                        PngErrorHandler error,
                                                                        PngErrorHandler warning) {
  using namespace tessera::image_module;
  static const auto set = Original<SetHandlers>("png_set_error_fn");
  if (set != nullptr) set(png, owner, Remember(error) ? HandleError : error, warning);
}
