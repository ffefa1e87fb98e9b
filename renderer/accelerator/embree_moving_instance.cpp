#include "renderer/accelerator/embree_moving_instance.h"

namespace tessera {
namespace {

void BoundsOfMoving(const RTCBoundsFunctionArguments* arguments) {
  const Bounds3& b = static_cast<const EmbreeMovingInstance*>(arguments->geometryUserPtr)->bounds;
  *arguments->bounds_o = {b.min.x, b.min.y, b.min.z, 0, b.max.x, b.max.y, b.max.z, 0};
}

// The ray of a context in an instance's space, while Embree searches that.
class InstanceVisit {
 public:
  InstanceVisit(RTCIntersectContext* context, const EmbreeMovingInstance& instance)
      : context_(*reinterpret_cast<EmbreeRayContext*>(context)),
        place_(*context_.geometry, instance.instance, context_.ray->time) {
    if (place_.is_flat()) return;
    ray_ = HitRay{*context_.ray, place_.render_from_group()}.InShapeSpace();
    context_.ray_in_instance = &ray_;
    context_.base.instID[0] = instance.geometry_id;
  }
  ~InstanceVisit() {
    context_.ray_in_instance = nullptr;
    context_.base.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
  InstanceVisit(const InstanceVisit&) = delete;
  InstanceVisit& operator=(const InstanceVisit&) = delete;

  bool is_flat() const { return place_.is_flat(); }
  // `ray` in the instance's space.
  RTCRay Enter(const RTCRay& ray) const {
    RTCRay inside = ray;
    const Vec3 o = ray_.o.ToFloat(), d = ray_.d.ToFloat();
    inside.org_x = o.x;
    inside.org_y = o.y;
    inside.org_z = o.z;
    inside.dir_x = d.x;
    inside.dir_y = d.y;
    inside.dir_z = d.z;
    return inside;
  }

 private:
  EmbreeRayContext& context_;
  const InstancePlace place_;
  DoubleRay ray_{};
};

void IntersectMoving(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  const auto& instance = *static_cast<const EmbreeMovingInstance*>(arguments->geometryUserPtr);
  auto* const ray_hit = reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  const InstanceVisit visit(arguments->context, instance);
  if (visit.is_flat()) return;
  RTCRayHit inside{visit.Enter(ray_hit->ray), {}};
  if (!IsTraceable(inside.ray, kTracedCoordinateMax)) return;
  inside.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(instance.group, arguments->context, &inside);
  if (inside.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
  ray_hit->ray.tfar = inside.ray.tfar;
  ray_hit->hit = inside.hit;
  ray_hit->hit.instID[0] = instance.geometry_id;
}

void OccludedMoving(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  const auto& instance = *static_cast<const EmbreeMovingInstance*>(arguments->geometryUserPtr);
  auto* const ray = reinterpret_cast<RTCRay*>(arguments->ray);
  const InstanceVisit visit(arguments->context, instance);
  if (visit.is_flat()) return;
  RTCRay inside = visit.Enter(*ray);
  if (!IsTraceable(inside, kTracedCoordinateMax)) return;
  rtcOccluded1(instance.group, arguments->context, &inside);
  ray->tfar = inside.tfar;  // negative infinity if it is occluded
}

}  // namespace

void SetMovingInstance(RTCGeometry geometry, EmbreeMovingInstance* instance) {
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryUserData(geometry, instance);
  rtcSetGeometryBoundsFunction(geometry, BoundsOfMoving, nullptr);
  rtcSetGeometryIntersectFunction(geometry, IntersectMoving);
  rtcSetGeometryOccludedFunction(geometry, OccludedMoving);
}

}  // namespace tessera
