#include "renderer/accelerator/accelerator.h"

#include <algorithm>
#include <thread>

#include "renderer/accelerator/embree_accelerator.h"
#include "renderer/accelerator/own_accelerator.h"

namespace tessera {
namespace {

constexpr Kind<AcceleratorMaker> kAccelerators[] = {
    {"embree", Support::kSupported, MakeEmbreeAccelerator},
    {"bvh", Support::kSupported, MakeBvhAccelerator},
    {"list", Support::kSupported, MakeListAccelerator},
};

}  // namespace

KindTable<AcceleratorMaker> Accelerators() {
  return {"accelerator", kAccelerators};
}

Result<std::unique_ptr<Accelerator>> MakeAccelerator(const Kind<AcceleratorMaker>& kind,
                                                     const Geometry& geometry, const TextureTable& textures) {
  return kind.reader(geometry, textures, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

}  // namespace tessera
