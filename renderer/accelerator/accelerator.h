// Finds what a ray hits. Immutable once built, shared by all threads.
#pragma once

#include <memory>

#include "renderer/description/kind_table.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/hit_lanes.h"
#include "renderer/shape/interaction.h"
#include "renderer/util/result.h"

namespace tessera {

struct AcceleratorStatistics {
  double build_seconds = 0;
  uint64_t nodes = 0;  // 0 if there are none or the number is unknown
  uint64_t bytes = 0;
  // Surface area cost: the expected number of tests (of a box of a child, a block of triangles, another
  // primitive) for a random line through the bounds. 0 if it is unknown.
  double sah_cost = 0;
};

// Finds what the rays of several lanes hit, with the same results as Accelerator. The set of lanes is not
// empty.
class LaneSearch {
 public:
  virtual ~LaneSearch() = default;
  // Returns the lanes whose rays hit anything. Hits are not refined: one counts if RefineHit accepts it;
  // otherwise Intersect finds another or none.
  virtual LaneSet Find(LaneSet lanes, HitLanes* hits) const = 0;
  // Returns the lanes whose rays, one for each lane, are occluded.
  virtual LaneSet Occluded(LaneSet lanes, const Ray* rays) const = 0;
};

class Accelerator {
 public:
  virtual ~Accelerator() = default;
  // Finds the nearest hit in (0, ray.t_max]; false if there is none. Takes alpha into account.
  virtual bool Intersect(const Ray& ray, Hit* hit) const = 0;
  // Whether any surface that stops shadow rays lies in (0, ray.t_max).
  virtual bool Occluded(const Ray& ray) const = 0;
  // The same for several rays at a time; null if there is nothing faster than one by one.
  virtual const LaneSearch* lane_search() const { return nullptr; }
  virtual AcceleratorStatistics statistics() const = 0;
};

// `build_threads` does not change any result. `geometry` and `textures` must outlive the accelerator. An
// error if the accelerator cannot hold the geometry.
using AcceleratorMaker = Result<std::unique_ptr<Accelerator>> (*)(const Geometry& geometry,
                                                                  const TextureTable& textures,
                                                                  int build_threads);

// The accelerators that the command line may name. The first is the default.
KindTable<AcceleratorMaker> Accelerators();

// Builds an accelerator with a thread for each core.
Result<std::unique_ptr<Accelerator>> MakeAccelerator(const Kind<AcceleratorMaker>& kind,
                                                     const Geometry& geometry, const TextureTable& textures);

}  // namespace tessera
