// Finds what a ray hits. Immutable once built, shared by all threads.
#pragma once

#include <array>
#include <memory>
#include <string_view>

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"
#include "renderer/util/result.h"

namespace tessera {

struct AcceleratorStatistics {
  double build_seconds = 0;
  uint64_t nodes = 0;  // 0 if there are none or the structure does not tell
  uint64_t bytes = 0;
  // Surface area cost: the expected number of tests (of a box of a child, a block of triangles, another
  // primitive) for a random line through the bounds. 0 if the structure does not tell.
  double sah_cost = 0;
};

class Accelerator {
 public:
  virtual ~Accelerator() = default;
  // The nearest hit in (0, ray.t_max]; false if there is none. Alpha is taken into account.
  virtual bool Intersect(const Ray& ray, Hit* hit) const = 0;
  // Whether anything but `interface` surfaces lies in (0, ray.t_max).
  virtual bool Occluded(const Ray& ray) const = 0;
  virtual AcceleratorStatistics statistics() const = 0;
};

inline constexpr std::array<std::string_view, 3> kAcceleratorKinds{"embree", "bvh", "list"};

// `kind` is "embree", "bvh" (a tree of our own) or "list" (every primitive is tried). An error if the kind is
// unknown or cannot hold a primitive of the scene. `geometry` and `textures` must outlive the accelerator.
Result<std::unique_ptr<Accelerator>> MakeAccelerator(std::string_view kind, const Geometry& geometry,
                                                     const TextureTable& textures);

}  // namespace tessera
