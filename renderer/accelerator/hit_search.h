// Finds the nearest hit, or any, among primitives that are offered in any order: what is found depends on the
// ray and the primitives alone.
//
// This holds because a primitive's candidate is a pure function of ray and primitive, and so is its key: its
// distance, or if larger that of whatever a traversal may discard it by (its own box, its instance's box, its
// nearest vertex). The least key wins, and among equals the lowest instance, shape and primitive. Distances
// are those of hit_refinement.h.
#pragma once

#include <bit>

#include "renderer/accelerator/alpha_test.h"
#include "renderer/accelerator/search_space.h"
#include "renderer/accelerator/traced_ray.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

template <bool kAny>
class HitSearch {
 public:
  HitSearch(const Geometry& geometry, const TextureTable& textures, const Ray& ray)
      : geometry_(geometry), textures_(textures), ray_(ray), limit_(ray.t_max) {}

  // From now on primitives are those of an instance, whose box the ray enters at `entry`.
  void EnterInstance(uint32_t instance, float entry) {
    instance_ = instance;
    entry_ = entry;
  }
  void LeaveInstance() { EnterInstance(Hit::kNoInstance, 0); }

  void TestBlock(const TriangleBlock& block, const TracedRay& ray);
  // Not an instance. `entry`: where the ray enters the primitive's box.
  void TestOther(const OtherPrimitive& other, const TracedRay& ray, float entry);

  // Primitives beyond this distance need not be offered.
  float limit() const { return limit_; }
  bool found() const { return best_.found; }
  bool is_done() const { return kAny && best_.found; }
  const Hit& hit() const { return best_.hit; }
  const Ray& ray() const { return ray_; }

 private:
  struct Best {
    Hit hit;
    bool found = false;
  };

  void TestLane(const TriangleBlock& block, int lane, const TracedRay& ray, float nearest_vertex);
  // Returns false if alpha lets the ray pass: it may meet the primitive once more. `crossing` counts.
  bool Offer(const Hit& hit, float key, bool has_alpha, int crossing);

  const Geometry& geometry_;
  const TextureTable& textures_;
  const Ray& ray_;
  float limit_;  // key of the best, or the end of the ray
  Best best_;
  uint32_t instance_ = Hit::kNoInstance;
  float entry_ = 0;
};

template <bool kAny>
inline void HitSearch<kAny>::TestBlock(const TriangleBlock& block, const TracedRay& ray) {
  alignas(32) float nearest[TriangleBlock::kLanes];
  unsigned lanes = CrossedLanes(block, ray, limit_, nearest);
  if (kAny) lanes &= ~unsigned{block.passed_by_shadow_rays};
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    TestLane(block, lane, ray, nearest[lane]);
    if (is_done()) return;
  }
}

}  // namespace tessera
