#include "renderer/accelerator/own_accelerator.h"

#include <chrono>
#include <utility>

#include "renderer/accelerator/bvh_builder.h"
#include "renderer/accelerator/bvh_traversal.h"
#include "renderer/accelerator/hit_search.h"
#include "renderer/shape/hit_refinement.h"

namespace tessera {
namespace {

enum class SearchMethod { kTree, kList };

class OwnAccelerator : public Accelerator {
 public:
  OwnAccelerator(const Geometry& geometry, const TextureTable& textures)
      : geometry_(geometry), textures_(textures) {}

  Result<void> Build(SearchMethod method, int threads) {
    const auto start = std::chrono::steady_clock::now();
    groups_.resize(geometry_.groups.size());
    for (size_t i = 0; i < groups_.size(); ++i) {
      const std::span<const Shape> shapes = geometry_.groups[i].shapes;
      Result<SearchSpace> group = BuildSpace(method, shapes, CollectPrimitives(shapes), threads);
      if (!group) return group.error();
      groups_[i] = *std::move(group);
    }
    std::vector<BoxedPrimitive> primitives = CollectPrimitives(geometry_.shapes);
    AddInstances(&primitives);
    Result<SearchSpace> top = BuildSpace(method, geometry_.shapes, std::move(primitives), threads);
    if (!top) return top.error();
    top_ = *std::move(top);
    statistics_ = Summarize(method);
    statistics_.build_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return {};
  }

  bool Intersect(const Ray& ray, Hit* hit) const override {
    HitSearch<false> search(geometry_, textures_, ray);
    Search(&search);
    if (!search.found()) return false;
    *hit = search.hit();
    return true;
  }

  bool Occluded(const Ray& ray) const override {
    HitSearch<true> search(geometry_, textures_, ray);
    Search(&search);
    return search.found();
  }

  AcceleratorStatistics statistics() const override { return statistics_; }

 private:
  static Result<SearchSpace> BuildSpace(SearchMethod method, std::span<const Shape> shapes,
                                        std::vector<BoxedPrimitive> primitives, int threads) {
    if (method == SearchMethod::kList) return MakeListSpace(shapes, primitives);
    return BuildBvhSpace(shapes, std::move(primitives), threads);
  }

  void AddInstances(std::vector<BoxedPrimitive>* primitives) const {
    for (size_t i = 0; i < geometry_.instances.size(); ++i) {
      const Instance& instance = geometry_.instances[i];
      const SearchSpace& group = groups_[static_cast<size_t>(instance.group)];
      if (group.empty()) continue;
      PrimitiveName name;
      name.shape = static_cast<uint32_t>(i);
      name.kind = PrimitiveKind::kInstance;
      primitives->push_back({geometry_.InstanceBounds(instance, group.bounds), name});
    }
  }

  AcceleratorStatistics Summarize(SearchMethod method) const {
    AcceleratorStatistics total;
    const auto add = [&total](const SearchSpace& space) {
      total.nodes += space.nodes.size();
      total.bytes += space.bytes();
    };
    add(top_);
    for (const SearchSpace& group : groups_) add(group);
    total.sah_cost = top_.cost;
    const double area = top_.bounds.empty() ? 0 : top_.bounds.SurfaceArea();
    for (const OtherPrimitive& other : top_.others) {
      if (other.name.kind != PrimitiveKind::kInstance) continue;
      const double share = area > 0 && method == SearchMethod::kTree ? other.bounds.SurfaceArea() / area : 1;
      total.sah_cost += share * GroupOf(other).cost;
    }
    return total;
  }

  const SearchSpace& GroupOf(const OtherPrimitive& instance) const {
    return groups_[static_cast<size_t>(geometry_.instances[instance.name.shape].group)];
  }

  template <bool kAny>
  void Search(HitSearch<kAny>* search) const {
    if (top_.empty()) return;
    SearchIn(top_, TracedRay({Double3(search->ray().o), Double3(search->ray().d)}, top_.bounds), search);
  }

  template <bool kAny>
  void SearchIn(const SearchSpace& space, const TracedRay& ray, HitSearch<kAny>* search) const {
    if (space.nodes.empty()) {
      for (const TriangleBlock& block : space.blocks) {
        search->TestBlock(block, ray);
        if (search->is_done()) return;
      }
      for (const OtherPrimitive& other : space.others) {
        TestOther(other, ray, search);
        if (search->is_done()) return;
      }
      return;
    }
    TraverseBvh<!kAny>(
        space, ray, [search] { return search->limit(); },
        [&](uint32_t leaf) {
          TestLeaf(space, leaf, ray, search);
          return search->is_done();
        });
  }

  template <bool kAny>
  void TestLeaf(const SearchSpace& space, uint32_t leaf, const TracedRay& ray,
                HitSearch<kAny>* search) const {
    if (!(leaf & BvhNode::kOthers)) {
      search->TestBlock(space.blocks[leaf & (BvhNode::kOthers - 1)], ray);
      return;
    }
    const uint32_t first = leaf & (BvhNode::kOthersMax - 1);
    const uint32_t count = leaf >> BvhNode::kCountShift & BvhNode::kOthersPerLeafMax;
    for (uint32_t i = first; i < first + count && !search->is_done(); ++i) {
      TestOther(space.others[i], ray, search);
    }
  }

  template <bool kAny>
  void TestOther(const OtherPrimitive& other, const TracedRay& ray, HitSearch<kAny>* search) const {
    float entry = 0;
    if (!ray.Enters(other.bounds, &entry) || entry > search->limit()) return;
    if (other.name.kind == PrimitiveKind::kInstance) {
      SearchInstance(other, entry, search);
    } else {
      search->TestOther(other, ray, entry);
    }
  }

  template <bool kAny>
  void SearchInstance(const OtherPrimitive& instance, float entry, HitSearch<kAny>* search) const {
    const SearchSpace& group = GroupOf(instance);
    const uint32_t index = instance.name.shape;
    const InstancePlace place(geometry_, index, search->ray().time);
    if (place.is_flat()) return;
    const DoubleRay ray = HitRay{search->ray(), place.render_from_group()}.InShapeSpace();
    search->EnterInstance(index, entry);
    SearchIn(group, TracedRay(ray, group.bounds), search);
    search->LeaveInstance();
  }

  const Geometry& geometry_;
  const TextureTable& textures_;
  SearchSpace top_;
  std::vector<SearchSpace> groups_;
  AcceleratorStatistics statistics_;
};

Result<std::unique_ptr<Accelerator>> MakeOwnAccelerator(SearchMethod method, const Geometry& geometry,
                                                        const TextureTable& textures, int build_threads) {
  auto accelerator = std::make_unique<OwnAccelerator>(geometry, textures);
  if (Result<void> built = accelerator->Build(method, build_threads); !built) return built.error();
  return std::unique_ptr<Accelerator>(std::move(accelerator));
}

}  // namespace

Result<std::unique_ptr<Accelerator>> MakeBvhAccelerator(const Geometry& geometry,
                                                        const TextureTable& textures, int build_threads) {
  return MakeOwnAccelerator(SearchMethod::kTree, geometry, textures, build_threads);
}

Result<std::unique_ptr<Accelerator>> MakeListAccelerator(const Geometry& geometry,
                                                         const TextureTable& textures, int build_threads) {
  return MakeOwnAccelerator(SearchMethod::kList, geometry, textures, build_threads);
}

}  // namespace tessera
