#include "renderer/accelerator/accelerator.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "renderer/accelerator/embree_accelerator.h"
#include "renderer/accelerator/own_accelerator.h"
#include "renderer/util/text.h"

namespace tessera {

Result<std::unique_ptr<Accelerator>> MakeAccelerator(std::string_view kind, const Geometry& geometry,
                                                     const TextureTable& textures) {
  const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (kind == "embree") return MakeEmbreeAccelerator(geometry, textures, threads);
  if (kind == "bvh") return MakeOwnAccelerator(SearchMethod::kTree, geometry, textures, threads);
  if (kind == "list") return MakeOwnAccelerator(SearchMethod::kList, geometry, textures, threads);
  return BadInput(fmt::format("unknown accelerator \"{}\"{}; expected embree, bvh or list", kind,
                              DidYouMean(kind, kAcceleratorKinds)));
}

}  // namespace tessera
