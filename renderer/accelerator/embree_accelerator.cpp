#include "renderer/accelerator/embree_accelerator.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>

#include "renderer/accelerator/embree_callbacks.h"
#include "renderer/accelerator/embree_device.h"
#include "renderer/accelerator/embree_moving_instances.h"
#include "renderer/accelerator/embree_scene.h"
#include "renderer/math/packed3.h"
#include "renderer/shape/hit_refinement.h"

namespace tessera {
namespace {

class EmbreeAccelerator : public Accelerator, private LaneSearch {
 public:
  EmbreeAccelerator(std::unique_ptr<EmbreeDevice> device, const Geometry& geometry,
                    const TextureTable& textures)
      : device_(std::move(device)),
        geometry_(geometry),
        textures_(textures),
        top_(*device_, geometry.shapes) {}

  Result<void> Build() {
    const auto start = std::chrono::steady_clock::now();
    AddGroups();
    for (size_t i = 0; i < geometry_.instances.size(); ++i) AddInstance(static_cast<uint32_t>(i));
    AddMovingInstances();
    rtcCommitScene(top_.handle());
    device_->EndBuild();
    build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return device_->Status();
  }

  bool Intersect(const Ray& ray, Hit* hit) const override {
    EmbreeRayContext context = MakeContext(ray);
    RTCRayHit query;
    if (!SetRay(ray, kAllMask, &query.ray)) return false;
    for (int attempt = 0; attempt < kFalseHitsMax; ++attempt) {
      if (!FindHit(ray, context, query, hit)) return false;
      if (RefineHit(geometry_, ray, hit)) return true;
      // The surface that the ray started on, found again by a rounding error of Embree's: continue beyond it.
      query.ray.tnear = NextFloatUp(query.ray.tfar);
    }
    return false;
  }

  const LaneSearch* lane_search() const override { return this; }
  LaneSet Find(LaneSet lanes, HitLanes* hits) const override {
    LaneSet found = 0;
    EmbreeRayContext context = MakeContext(*hits->rays[std::countr_zero(lanes)]);
    RTCRayHit query;
    ForEachLane(lanes, [&](int lane) {
      const Ray& ray = *hits->rays[lane];
      context.ray = &ray;
      const bool is_hit =
          SetRay(ray, kAllMask, &query.ray) && FindHit(ray, context, query, &hits->hits[lane]);
      found |= LaneSet{is_hit} << lane;
    });
    return found;
  }
  LaneSet Occluded(LaneSet lanes, const Ray* rays) const override {
    LaneSet occluded = 0;
    EmbreeRayContext context = MakeContext(rays[std::countr_zero(lanes)]);
    RTCRay query;
    ForEachLane(lanes, [&](int lane) {
      context.ray = &rays[lane];
      if (!SetRay(rays[lane], kSolidMask, &query)) return;
      rtcOccluded1(top_.handle(), &context.base, &query);
      occluded |= LaneSet{query.tfar < 0} << lane;
    });
    return occluded;
  }

  bool Occluded(const Ray& ray) const override {
    EmbreeRayContext context = MakeContext(ray);
    RTCRay query;
    if (!SetRay(ray, kSolidMask, &query)) return false;
    rtcOccluded1(top_.handle(), &context.base, &query);
    return query.tfar < 0;
  }

  AcceleratorStatistics statistics() const override { return {build_seconds_, 0, device_->bytes(), 0}; }

 private:
  // Consecutive false hits after which a ray counts as a miss; even one is rare.
  static constexpr int kFalseHitsMax = 16;

  // Those that have an instance.
  void AddGroups() {
    enum class GroupUse : uint8_t { kNone, kMoving, kStill };
    std::vector<GroupUse> uses(geometry_.groups.size(), GroupUse::kNone);
    for (const Instance& instance : geometry_.instances) {
      GroupUse& use = uses[static_cast<size_t>(instance.group)];
      use = std::max(use, instance.motion < 0 ? GroupUse::kStill : GroupUse::kMoving);
    }
    groups_.resize(geometry_.groups.size());
    for (size_t i = 0; i < groups_.size(); ++i) {
      if (uses[i] == GroupUse::kNone) continue;
      const auto use = uses[i] == GroupUse::kMoving ? EmbreeScene::Use::kByUs : EmbreeScene::Use::kByEmbree;
      groups_[i] = std::make_unique<EmbreeScene>(*device_, geometry_.groups[i].shapes, use);
      if (groups_[i]->handle() != nullptr) rtcCommitScene(groups_[i]->handle());
    }
  }

  void AddInstance(uint32_t index) {
    const Instance& instance = geometry_.instances[index];
    const EmbreeScene& group = *groups_[static_cast<size_t>(instance.group)];
    if (group.geometry_count() == 0) return;
    if (instance.motion >= 0) {
      moving_.instances.push_back({index, &group, geometry_.InstanceBounds(instance, group.Bounds())});
      return;
    }
    Attach(MakeInstance(instance, group));
    instances_.push_back(index);
  }

  // After those that stand still.
  void AddMovingInstances() {
    if (moving_.instances.empty()) return;
    moving_.first_id = static_cast<unsigned>(top_.geometry_count() + instances_.size());
    const EmbreeGeometryHandle geometry(rtcNewGeometry(device_->handle(), RTC_GEOMETRY_TYPE_USER));
    moving_.Set(geometry.get());
    Attach(geometry);
    for (const EmbreeMovingInstance& moving : moving_.instances) instances_.push_back(moving.instance);
  }

  // As the next geometry of the top level.
  void Attach(const EmbreeGeometryHandle& geometry) {
    rtcSetGeometryMask(geometry.get(), kAllMask);
    rtcCommitGeometry(geometry.get());
    const auto id = static_cast<unsigned>(top_.geometry_count() + instances_.size());
    rtcAttachGeometryByID(top_.handle(), geometry.get(), id);
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

  // Returns false if Embree must not be given the ray: IsTraceable of all its numbers.
  bool SetRay(const Ray& ray, unsigned mask, RTCRay* r) const {
    static_assert(offsetof(RTCRay, tnear) == 3 * sizeof(float) &&
                  offsetof(RTCRay, dir_x) == 4 * sizeof(float));
    const Packed3 o = Packed3::Load(ray.o), d = Packed3::Load(ray.d);
    const __m128 t_near = _mm_set1_ps(std::numeric_limits<float>::min());  // t = 0 is not a hit
    _mm_store_ps(&r->org_x, _mm_blend_ps(o.v, t_near, 8));
    _mm_store_ps(&r->dir_x, d.v);  // and the time, which is 0
    r->tfar = ray.t_max;
    r->mask = mask;
    r->id = 0;
    r->flags = 0;
    const Packed3 ones(_mm_set1_ps(1));
    return Dot(Abs(o), ones) <= origin_max_ && Dot(Abs(d), ones) <= kTracedCoordinateMax && ray.t_max > 0;
  }

  // Finds the nearest hit from query.ray.tnear on, not refined.
  bool FindHit(const Ray& ray, EmbreeRayContext& context, RTCRayHit& query, Hit* hit) const {
    query.ray.tfar = ray.t_max;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(top_.handle(), &context.base, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    *hit = MakeHit(query, context);
    return true;
  }

  Hit MakeHit(const RTCRayHit& query, const EmbreeRayContext& context) const {
    Hit hit;
    hit.t = query.ray.tfar;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    hit.instance = context.InstanceOf(query.hit.instID[0]);
    const EmbreeScene& scene =
        hit.instance == Hit::kNoInstance ? top_ : *groups_[geometry_.instances[hit.instance].group];
    const EmbreeGeometryRecord& record = scene.records()[query.hit.geomID];
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
  EmbreeMovingInstances moving_;
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
