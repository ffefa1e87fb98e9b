#include "renderer/accelerator/embree_moving_instances.h"

namespace tessera {
namespace {

const EmbreeMovingInstances& MovingOf(void* user_data) {
  return *static_cast<const EmbreeMovingInstances*>(user_data);
}

void BoundsOfMoving(const RTCBoundsFunctionArguments* arguments) {
  const Bounds3& b = MovingOf(arguments->geometryUserPtr).instances[arguments->primID].bounds;
  *arguments->bounds_o = {b.min.x, b.min.y, b.min.z, 0, b.max.x, b.max.y, b.max.z, 0};
}

// The ray of a context in an instance's space, while Embree searches that.
class InstanceVisit {
 public:
  InstanceVisit(RTCIntersectContext* context, const EmbreeMovingInstances& moving, unsigned index)
      : instance_(moving.instances[index]),
        id_(moving.first_id + index),
        context_(*reinterpret_cast<EmbreeRayContext*>(context)),
        place_(*context_.geometry, instance_.instance, context_.ray->time) {
    if (place_.is_flat()) return;
    ray_ = HitRay{*context_.ray, place_.render_from_group()}.InShapeSpace();
    context_.ray_in_instance = &ray_;
    context_.base.instID[0] = id_;
  }
  ~InstanceVisit() {
    context_.ray_in_instance = nullptr;
    context_.base.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
  InstanceVisit(const InstanceVisit&) = delete;
  InstanceVisit& operator=(const InstanceVisit&) = delete;

  bool is_flat() const { return place_.is_flat(); }
  unsigned id() const { return id_; }
  const EmbreeScene& group() const { return *instance_.group; }
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
  const EmbreeMovingInstance& instance_;
  unsigned id_;
  EmbreeRayContext& context_;
  const InstancePlace place_;
  DoubleRay ray_{};
};

void IntersectMoving(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  auto* const ray_hit = reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  const InstanceVisit visit(arguments->context, MovingOf(arguments->geometryUserPtr), arguments->primID);
  if (visit.is_flat()) return;
  RTCRayHit inside{visit.Enter(ray_hit->ray), {}};
  if (!IsTraceable(inside.ray, kTracedCoordinateMax)) return;
  inside.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  if (visit.group().handle() != nullptr) {
    rtcIntersect1(visit.group().handle(), arguments->context, &inside);
  } else {
    TryUserPrimitives(visit.group().records(), arguments->context, &inside);
  }
  if (inside.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
  ray_hit->ray.tfar = inside.ray.tfar;
  ray_hit->hit = inside.hit;
  ray_hit->hit.instID[0] = visit.id();
}

void OccludedMoving(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  auto* const ray = reinterpret_cast<RTCRay*>(arguments->ray);
  const InstanceVisit visit(arguments->context, MovingOf(arguments->geometryUserPtr), arguments->primID);
  if (visit.is_flat()) return;
  RTCRay inside = visit.Enter(*ray);
  if (!IsTraceable(inside, kTracedCoordinateMax)) return;
  if (visit.group().handle() != nullptr) {
    rtcOccluded1(visit.group().handle(), arguments->context, &inside);
  } else {
    TryUserPrimitives(visit.group().records(), arguments->context, &inside);
  }
  ray->tfar = inside.tfar;  // negative infinity if it is occluded
}

}  // namespace

void EmbreeMovingInstances::Set(RTCGeometry geometry) {
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(instances.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, BoundsOfMoving, nullptr);
  rtcSetGeometryIntersectFunction(geometry, IntersectMoving);
  rtcSetGeometryOccludedFunction(geometry, OccludedMoving);
}

}  // namespace tessera
