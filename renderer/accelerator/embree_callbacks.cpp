#include "renderer/accelerator/embree_callbacks.h"

#include <algorithm>

#include "renderer/accelerator/alpha_test.h"
#include "renderer/shape/hit_refinement.h"
#include "renderer/shape/ray_crossings.h"
#include "renderer/shape/shape_sampling.h"

namespace tessera {
namespace {

const EmbreeRayContext& ContextOf(const RTCIntersectContext* context) {
  return *reinterpret_cast<const EmbreeRayContext*>(context);
}

bool AlphaIsHit(const EmbreeRayContext& context, const FloatInput& alpha, const Hit& hit, int crossing) {
  return AlphaIsHit(*context.geometry, *context.textures, *context.ray, alpha, hit, crossing);
}

void Bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& record = *static_cast<const EmbreeGeometryRecord*>(arguments->geometryUserPtr);
  const Bounds3 b = ShapeBounds(*record.shape, record.Primitive(arguments->primID));
  *arguments->bounds_o = {b.min.x, b.min.y, b.min.z, 0, b.max.x, b.max.y, b.max.z, 0};
}

// The hit of the context's ray with one of our own primitives, alpha taken into account.
bool IntersectUserPrimitive(const EmbreeRayContext& context, const EmbreeGeometryRecord& record,
                            unsigned embree_primitive, float t_max, Hit* hit) {
  hit->shape = record.shape_index;
  hit->primitive = record.Primitive(embree_primitive);
  hit->instance = context.InstanceOf(context.base.instID[0]);
  const DoubleRay ray = context.ray_in_instance
                            ? *context.ray_in_instance
                            : RayInShapeSpace(*context.geometry, hit->instance, *context.ray);
  const SurfaceProperties& surface = record.shape->surface;
  Crossing found;
  bool is_found = NearestCrossing(*record.shape, hit->primitive, ray, t_max, &found);
  for (int crossing = 0; is_found && crossing < kCrossingsMax; ++crossing) {
    hit->t = std::min(static_cast<float>(found.t), t_max);
    hit->u = found.u;
    hit->v = found.v;
    if (!surface.HasAlpha() || AlphaIsHit(context, surface.alpha, *hit, crossing)) return true;
    is_found = NextCrossing(*record.shape, hit->primitive, ray, found.t, t_max, &found);
  }
  return false;
}

void IntersectOne(const EmbreeGeometryRecord& record, unsigned geometry, unsigned primitive,
                  RTCIntersectContext* context, RTCRayHit* ray_hit) {
  Hit hit;
  if (!IntersectUserPrimitive(ContextOf(context), record, primitive, ray_hit->ray.tfar, &hit)) return;
  ray_hit->ray.tfar = hit.t;
  ray_hit->hit.u = hit.u;
  ray_hit->hit.v = hit.v;
  ray_hit->hit.primID = primitive;
  ray_hit->hit.geomID = geometry;
  ray_hit->hit.instID[0] = context->instID[0];
}

void OccludeOne(const EmbreeGeometryRecord& record, unsigned primitive, RTCIntersectContext* context,
                RTCRay* ray) {
  Hit hit;
  if (IntersectUserPrimitive(ContextOf(context), record, primitive, ray->tfar, &hit))
    ray->tfar = -std::numeric_limits<float>::infinity();  // Embree's mark of an occluded ray
}

void Intersect(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  IntersectOne(*static_cast<const EmbreeGeometryRecord*>(arguments->geometryUserPtr), arguments->geomID,
               arguments->primID, arguments->context, reinterpret_cast<RTCRayHit*>(arguments->rayhit));
}

void Occluded(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  OccludeOne(*static_cast<const EmbreeGeometryRecord*>(arguments->geometryUserPtr), arguments->primID,
             arguments->context, reinterpret_cast<RTCRay*>(arguments->ray));
}

// Whether the mask of a ray leaves the record out, as in Embree.
bool IsMasked(const EmbreeGeometryRecord& record, unsigned mask) {
  return (mask & MaskOf(*record.shape)) == 0;
}

Hit HitOf(const EmbreeRayContext& context, const EmbreeGeometryRecord& record,
          const RTCFilterFunctionNArguments* a) {
  const auto* found = reinterpret_cast<const RTCHit*>(a->hit);
  const auto* ray = reinterpret_cast<const RTCRay*>(a->ray);
  return {ray->tfar,
          found->u,
          found->v,
          record.shape_index,
          record.Primitive(found->primID),
          context.InstanceOf(found->instID[0])};
}

void FilterByAlpha(const RTCFilterFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  const EmbreeRayContext& context = ContextOf(arguments->context);
  const auto& record = *static_cast<const EmbreeGeometryRecord*>(arguments->geometryUserPtr);
  Hit hit = HitOf(context, record, arguments);
  const bool is_hit = RefineHit(*context.geometry, *context.ray, &hit) &&
                      AlphaIsHit(context, record.shape->surface.alpha, hit, 0);
  if (!is_hit) arguments->valid[0] = 0;
}

// Whether a hit of Embree's is too far from the ray's origin for its distance to be only a rounding error.
// The distance is (v0 . n) / (d . n) for a corner v0, as seen from the origin, and the normal n = e1 x e2:
// its numerator is off by some epsilons of |v0| |e1| |e2|.
bool IsSurelyAhead(const RTCRay& ray, const RTCHit& hit, float edge_max) {
  const Vec3 d{ray.dir_x, ray.dir_y, ray.dir_z};
  const float d_dot_n = AbsDot(d, {hit.Ng_x, hit.Ng_y, hit.Ng_z});
  const float corner_distance_max = ray.tfar * Length(d) + edge_max;
  return ray.tfar * d_dot_n > Gamma(32) * corner_distance_max * edge_max * edge_max;
}

void FilterOcclusion(const RTCFilterFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  const auto& record = *static_cast<const EmbreeGeometryRecord*>(arguments->geometryUserPtr);
  const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
  if (IsSurelyAhead(ray, *reinterpret_cast<const RTCHit*>(arguments->hit), record.edge_max)) return;
  const EmbreeRayContext& context = ContextOf(arguments->context);
  Hit hit = HitOf(context, record, arguments);
  if (!RefineHit(*context.geometry, *context.ray, &hit)) arguments->valid[0] = 0;
}

}  // namespace

void SetUserPrimitiveCallbacks(RTCGeometry geometry) {
  rtcSetGeometryBoundsFunction(geometry, Bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, Intersect);
  rtcSetGeometryOccludedFunction(geometry, Occluded);
}

void TryUserPrimitives(std::span<const EmbreeGeometryRecord> records, RTCIntersectContext* context,
                       RTCRayHit* ray_hit) {
  for (unsigned i = 0; i < records.size(); ++i) {
    if (IsMasked(records[i], ray_hit->ray.mask)) continue;
    const uint32_t count = records[i].shape->PrimitiveCount();
    for (uint32_t primitive = 0; primitive < count; ++primitive)
      IntersectOne(records[i], i, primitive, context, ray_hit);
  }
}

void TryUserPrimitives(std::span<const EmbreeGeometryRecord> records, RTCIntersectContext* context,
                       RTCRay* ray) {
  for (const EmbreeGeometryRecord& record : records) {
    if (IsMasked(record, ray->mask)) continue;
    const uint32_t count = record.shape->PrimitiveCount();
    for (uint32_t primitive = 0; primitive < count; ++primitive) {
      OccludeOne(record, primitive, context, ray);
      if (ray->tfar < 0) return;
    }
  }
}

void SetAlphaFilter(RTCGeometry geometry) {
  rtcSetGeometryIntersectFilterFunction(geometry, FilterByAlpha);
  rtcSetGeometryOccludedFilterFunction(geometry, FilterByAlpha);
}

void SetOcclusionFilter(RTCGeometry geometry) {
  rtcSetGeometryOccludedFilterFunction(geometry, FilterOcclusion);
}

}  // namespace tessera
