// The module of another release.
#include "renderer/formats/module_interface.h"

extern "C" const tessera::image_module::Functions* TesseraImageFormats() {
  static constexpr tessera::image_module::Functions kFunctions{
      tessera::image_module::kVersion + 1, nullptr, nullptr, nullptr, nullptr, nullptr};
  return &kFunctions;
}
