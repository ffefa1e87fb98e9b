#include "renderer/accelerator/embree_accelerator.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>
#include <utility>

#include "renderer/accelerator/embree_callbacks.h"
#include "renderer/accelerator/embree_device.h"
#include "renderer/accelerator/embree_moving_instance.h"
#include "renderer/accelerator/embree_scene.h"
#include "renderer/shape/hit_refinement.h"

namespace tessera {
namespace {

class EmbreeAccelerator : public Accelerator {
 public:
  EmbreeAccelerator(std::unique_ptr<EmbreeDevice> device, const Geometry& geometry,
                    const TextureTable& textures)
      : device_(std::move(device)),
        geometry_(geometry),
        textures_(textures),
        top_(*device_, geometry.shapes) {}

  Result<void> Build() {
    const auto start = std::chrono::steady_clock::now();
    groups_.resize(geometry_.groups.size());
    for (size_t i = 0; i < geometry_.instances.size(); ++i) AddInstance(static_cast<uint32_t>(i));
    rtcCommitScene(top_.handle());
    device_->EndBuild();
    build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return device_->Status();
  }

  bool Intersect(const Ray& ray, Hit* hit) const override {
    EmbreeRayContext context = MakeContext(ray);
    RTCRayHit query;
    query.ray = MakeRay(ray, kAllMask);
    if (!IsTraceable(query.ray, origin_max_)) return false;
    for (int attempt = 0; attempt < kFalseHitsMax; ++attempt) {
      query.ray.tfar = ray.t_max;
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(top_.handle(), &context.base, &query);
      if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
      *hit = MakeHit(query, context);
      if (RefineHit(geometry_, ray, hit)) return true;
      // The surface that the ray started on, found again by a rounding error of Embree's: continue beyond it.
      query.ray.tnear = NextFloatUp(query.ray.tfar);
    }
    return false;
  }

  bool Occluded(const Ray& ray) const override {
    EmbreeRayContext context = MakeContext(ray);
    RTCRay query = MakeRay(ray, kSolidMask);
    if (!IsTraceable(query, origin_max_)) return false;
    rtcOccluded1(top_.handle(), &context.base, &query);
    return query.tfar < 0;
  }

  AcceleratorStatistics statistics() const override { return {build_seconds_, 0, device_->bytes(), 0}; }

 private:
  // Consecutive false hits after which a ray counts as a miss; even one is rare.
  static constexpr int kFalseHitsMax = 16;

  void AddInstance(uint32_t index) {
    const Instance& instance = geometry_.instances[index];
    std::unique_ptr<EmbreeScene>& group = groups_[instance.group];
    if (!group) {
      group = std::make_unique<EmbreeScene>(*device_, geometry_.groups[instance.group].shapes);
      rtcCommitScene(group->handle());
    }
    if (group->geometry_count() == 0) return;
    const uint32_t id = static_cast<uint32_t>(top_.geometry_count() + instances_.size());
    const EmbreeGeometryHandle geometry =
        instance.motion < 0 ? MakeInstance(instance, *group) : MakeMovingInstance(index, id, *group);
    rtcSetGeometryMask(geometry.get(), kAllMask);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(top_.handle(), geometry.get(), id);
    instances_.push_back(index);
  }

  EmbreeGeometryHandle MakeInstance(const Instance& instance, const EmbreeScene& group) {
    EmbreeGeometryHandle geometry(rtcNewGeometry(device_->handle(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), group.handle());
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                            instance.render_from_group.matrix().m.data());
    for (const std::array<float, 4>& row : instance.render_from_group.inverse_matrix().m) {
      const float growth = std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]);
      origin_max_ = std::min(origin_max_, kTracedCoordinateMax / std::max(1.0f, growth));
    }
    return geometry;
  }

  EmbreeGeometryHandle MakeMovingInstance(uint32_t index, unsigned id, const EmbreeScene& group) {
    const Instance& instance = geometry_.instances[index];
    RTCBounds bounds;
    rtcGetSceneBounds(group.handle(), &bounds);
    const Bounds3 of_group{{bounds.lower_x, bounds.lower_y, bounds.lower_z},
                           {bounds.upper_x, bounds.upper_y, bounds.upper_z}};
    moving_.push_back({index, id, group.handle(), geometry_.InstanceBounds(instance, of_group)});
    EmbreeGeometryHandle geometry(rtcNewGeometry(device_->handle(), RTC_GEOMETRY_TYPE_USER));
    SetMovingInstance(geometry.get(), &moving_.back());
    return geometry;
  }

  EmbreeRayContext MakeContext(const Ray& ray) const {
    EmbreeRayContext context;
    rtcInitIntersectContext(&context.base);  // incoherent rays
    context.ray = &ray;
    context.geometry = &geometry_;
    context.textures = &textures_;
    context.instances = instances_.data();
    context.first_instance = static_cast<uint32_t>(top_.geometry_count());
    return context;
  }

  static RTCRay MakeRay(const Ray& ray, unsigned mask) {
    RTCRay r;
    r.org_x = ray.o.x;
    r.org_y = ray.o.y;
    r.org_z = ray.o.z;
    r.tnear = std::numeric_limits<float>::min();  // t = 0 is not a hit
    r.dir_x = ray.d.x;
    r.dir_y = ray.d.y;
    r.dir_z = ray.d.z;
    r.time = 0;
    r.tfar = ray.t_max;
    r.mask = mask;
    r.id = 0;
    r.flags = 0;
    return r;
  }

  Hit MakeHit(const RTCRayHit& query, const EmbreeRayContext& context) const {
    Hit hit;
    hit.t = query.ray.tfar;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    hit.instance = context.InstanceOf(query.hit.instID[0]);
    const EmbreeScene& scene =
        hit.instance == Hit::kNoInstance ? top_ : *groups_[geometry_.instances[hit.instance].group];
    const EmbreeGeometryRecord& record = scene.record(query.hit.geomID);
    hit.shape = record.shape_index;
    hit.primitive = record.Primitive(query.hit.primID);
    return hit;
  }

  std::unique_ptr<EmbreeDevice> device_;  // first: outlives the scenes
  const Geometry& geometry_;
  const TextureTable& textures_;
  EmbreeScene top_;
  std::vector<std::unique_ptr<EmbreeScene>> groups_;  // null if it has no instance
  std::vector<uint32_t> instances_;                   // those that are not empty
  std::deque<EmbreeMovingInstance> moving_;           // callbacks hold pointers to them
  // Rays that start farther away would be too large in the space of an instance: they count as misses.
  float origin_max_ = kTracedCoordinateMax;
  double build_seconds_ = 0;
};

}  // namespace

Result<std::unique_ptr<Accelerator>> MakeEmbreeAccelerator(const Geometry& geometry,
                                                           const TextureTable& textures, int build_threads) {
  Result<std::unique_ptr<EmbreeDevice>> device = EmbreeDevice::Make(build_threads);
  if (!device) return device.error();
  auto accelerator = std::make_unique<EmbreeAccelerator>(*std::move(device), geometry, textures);
  if (Result<void> built = accelerator->Build(); !built) return built.error();
  return std::unique_ptr<Accelerator>(std::move(accelerator));
}

}  // namespace tessera
