#include "accelerator/accelerator.h"

#include <fmt/format.h>

#include <array>
#include <thread>

#include "accelerator/embree_accelerator.h"
#include "util/text.h"

namespace tessera {

Result<std::unique_ptr<Accelerator>> MakeAccelerator(std::string_view kind, const Geometry& geometry,
                                                     const TextureTable& textures) {
  static constexpr std::array<std::string_view, 1> kKinds{"embree"};
  if (kind == "embree") {
    const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    return MakeEmbreeAccelerator(geometry, textures, threads);
  }
  return BadInput(
      fmt::format("unknown accelerator \"{}\"{}; expected embree", kind, DidYouMean(kind, kKinds)));
}

}  // namespace tessera
