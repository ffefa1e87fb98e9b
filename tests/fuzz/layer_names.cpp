// The names of layers for the fuzzer, which is not linked with the renderer that fills them.
#include "renderer/scene/scene.h"

namespace tessera {

std::vector<std::string_view> AovNames() {
  return {"albedo", "depth", "samples"};
}

}  // namespace tessera
