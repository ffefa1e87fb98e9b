#include "renderer/accelerator/hit_search.h"

#include <algorithm>
#include <tuple>

#include "renderer/shape/patch_intersection.h"
#include "renderer/shape/ray_crossings.h"

namespace tessera {
namespace {

bool PrecedesInOrder(const Hit& a, const Hit& b) {
  return std::tie(a.instance, a.shape, a.primitive) < std::tie(b.instance, b.shape, b.primitive);
}

Bounds3 BoundsOf(const TrianglePoints& triangle) {
  return {Min(Min(triangle.p0, triangle.p1), triangle.p2), Max(Max(triangle.p0, triangle.p1), triangle.p2)};
}

// Like TriangleMesh::Refine, but rejects hits beyond the end of the ray.
bool RefineOnTriangle(const TrianglePoints& triangle, const DoubleRay& ray, float t_max, Hit* hit) {
  TriangleCrossing crossing;
  if (!CrossTriangle(triangle, ray, &crossing)) return false;
  if (!(crossing.t > 0 && crossing.t <= t_max)) return false;
  const double u = std::clamp(crossing.u, 0.0, 1.0);
  hit->t = static_cast<float>(crossing.t);
  hit->u = static_cast<float>(u);
  hit->v = static_cast<float>(std::clamp(crossing.v, 0.0, 1 - u));
  return true;
}

bool RefineOnParallelogram(const Shape& shape, const DoubleRay& ray, float t_max, Hit* hit) {
  Crossing found;
  const PatchPoints patch = std::get<BilinearMesh>(shape.form).At(hit->primitive);
  if (!CrossParallelogram(patch, ray, &found) || !(found.t > 0 && found.t <= t_max)) return false;
  *hit = {static_cast<float>(found.t), found.u, found.v, hit->shape, hit->primitive, hit->instance};
  return true;
}

}  // namespace

template <bool kAny>
bool HitSearch<kAny>::Offer(const Hit& hit, float key, bool has_alpha, int crossing) {
  if (!(key <= limit_)) return true;
  if (key == limit_ && best_.found && !PrecedesInOrder(hit, best_.hit)) return true;
  if (has_alpha) {
    const FloatInput& alpha = ShapeOf(geometry_, hit.instance, hit.shape).surface.alpha;
    if (!AlphaIsHit(geometry_, textures_, ray_, alpha, hit, crossing)) return false;
  }
  best_ = {hit, true};
  limit_ = key;
  return true;
}

template <bool kAny>
void HitSearch<kAny>::TestLane(const TriangleBlock& block, int lane, const TracedRay& ray,
                               float nearest_vertex) {
  const TrianglePoints triangle = block.Triangle(lane);
  float entry = 0;
  if (!ray.Enters(BoundsOf(triangle), &entry)) return;
  Hit hit;
  hit.shape = block.shape[lane];
  hit.primitive = block.primitive[lane];
  hit.instance = instance_;
  const bool is_hit =
      block.of_patches >> lane & 1
          ? RefineOnParallelogram(ShapeOf(geometry_, instance_, hit.shape), ray.exact, ray_.t_max, &hit)
          : RefineOnTriangle(triangle, ray.exact, ray_.t_max, &hit);
  if (!is_hit) return;
  Offer(hit, std::max({hit.t, nearest_vertex, entry, entry_}), block.with_alpha >> lane & 1, 0);
}

template <bool kAny>
void HitSearch<kAny>::TestOther(const OtherPrimitive& other, const TracedRay& ray, float entry) {
  if (kAny && !other.name.stops_shadow_rays) return;
  Hit hit;
  hit.shape = other.name.shape;
  hit.primitive = other.name.primitive;
  hit.instance = instance_;
  const Shape& shape = ShapeOf(geometry_, instance_, hit.shape);
  Crossing found;
  bool is_found = NearestCrossing(shape, hit.primitive, ray.exact, ray_.t_max, &found);
  for (int crossing = 0; is_found && crossing < kCrossingsMax; ++crossing) {
    hit.t = std::min(static_cast<float>(found.t), ray_.t_max);
    hit.u = found.u;
    hit.v = found.v;
    if (Offer(hit, std::max({hit.t, entry, entry_}), other.name.has_alpha, crossing)) return;
    is_found = NextCrossing(shape, hit.primitive, ray.exact, found.t, ray_.t_max, &found);
  }
}

template class HitSearch<false>;
template class HitSearch<true>;

}  // namespace tessera
