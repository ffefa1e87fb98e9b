#include "renderer/accelerator/binary_tree.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>

namespace tessera {
namespace {

constexpr int kBins = 16;
// In units of a test of a block of triangles.
constexpr float kTraversalCost = 0.4f, kOtherCost = 1.5f;
// Below this depth both halves get equal numbers of primitives, which bounds the depth of the tree.
constexpr int kHeuristicDepthMax = 60;
// With fewer primitives, starting a thread costs more than it saves.
constexpr uint32_t kPrimitivesPerThreadMin = 8192;

struct Bin {
  Bounds3 bounds;
  uint32_t triangles = 0, others = 0;

  void Add(const BoxedPrimitive& primitive) {
    bounds.Add(primitive.bounds);
    ++(IsTriangle(primitive.name.kind) ? triangles : others);
  }
  void Add(const Bin& bin) {
    bounds.Add(bin.bounds);
    triangles += bin.triangles;
    others += bin.others;
  }
  // Of testing all of them.
  float Cost() const {
    const auto blocks = (triangles + TriangleBlock::kLanes - 1) / TriangleBlock::kLanes;
    return static_cast<float>(blocks) + kOtherCost * static_cast<float>(others);
  }
  bool FitsInLeaf() const {
    return others == 0 ? triangles <= TriangleBlock::kLanes
                       : triangles == 0 && others <= BvhNode::kOthersPerLeafMax;
  }
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;  // -1: none
  int bin = 0;    // first bin on the right
};

// Bins of the centres (twice their coordinates) of boxes along an axis.
struct Binning {
  Binning(const Bounds3& centers, int on_axis)
      : axis(on_axis), min(centers.min[on_axis]), scale(kBins / (centers.max[on_axis] - min)) {}
  int BinOf(const Bounds3& b) const {
    const float bin = (b.min[axis] + b.max[axis] - min) * scale;
    return std::clamp(static_cast<int>(bin), 0, kBins - 1);
  }

  int axis;
  float min, scale;
};

class TreeBuilder {
 public:
  TreeBuilder(std::span<BoxedPrimitive> primitives, BinaryNode* nodes, int threads)
      : primitives_(primitives), nodes_(nodes), idle_threads_(threads - 1) {}

  void Build(uint32_t node, uint32_t begin, uint32_t end, int depth) {
    Bin all;
    Bounds3 centers;
    for (const BoxedPrimitive& primitive : primitives_.subspan(begin, end - begin)) {
      all.Add(primitive);
      centers.Add(primitive.bounds.min + primitive.bounds.max);
    }
    nodes_[node] = {all.bounds, begin, end, 0};
    const Split split = depth < kHeuristicDepthMax ? BestSplit(begin, end, all, centers) : Split{};
    if (all.FitsInLeaf() && !(split.cost < all.Cost())) return;
    const uint32_t middle = Partition(begin, end, split, all, centers);
    const uint32_t right = node + 2 * (middle - begin);
    nodes_[node].right = right;
    BuildChildren(node + 1, right, begin, middle, end, depth + 1);
  }

 private:
  void BuildChildren(uint32_t left, uint32_t right, uint32_t begin, uint32_t middle, uint32_t end,
                     int depth) {
    const bool is_large = std::min(middle - begin, end - middle) >= kPrimitivesPerThreadMin;
    if (is_large && idle_threads_.fetch_sub(1) > 0) {
      BuildInParallel(left, right, begin, middle, end, depth);
      idle_threads_.fetch_add(1);
      return;
    }
    if (is_large) idle_threads_.fetch_add(1);
    Build(left, begin, middle, depth);
    Build(right, middle, end, depth);
  }

  // Builds the left child on another thread or, if none can be started, on this one.
  void BuildInParallel(uint32_t left, uint32_t right, uint32_t begin, uint32_t middle, uint32_t end,
                       int depth) {
    std::exception_ptr failure;
    std::jthread helper;
    const auto build_left = [=, this] { Build(left, begin, middle, depth); };
    try {
      helper = std::jthread([&failure, build_left] {
        try {
          build_left();
        } catch (...) {
          failure = std::current_exception();
        }
      });
    } catch (const std::system_error&) {
      build_left();
    }
    Build(right, middle, end, depth);
    if (helper.joinable()) helper.join();
    if (failure) std::rethrow_exception(failure);
  }

  Split BestSplit(uint32_t begin, uint32_t end, const Bin& all, const Bounds3& centers) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centers.max[axis] > centers.min[axis])) continue;
      const Binning binning(centers, axis);
      if (!std::isfinite(binning.scale)) continue;
      std::array<Bin, kBins> bins;
      for (const BoxedPrimitive& primitive : primitives_.subspan(begin, end - begin)) {
        bins[static_cast<size_t>(binning.BinOf(primitive.bounds))].Add(primitive);
      }
      Improve(bins, axis, all.bounds.SurfaceArea(), &best);
    }
    return best;
  }

  static void Improve(const std::array<Bin, kBins>& bins, int axis, float area, Split* best) {
    std::array<float, kBins> right_cost;
    Bin right;
    for (size_t i = kBins - 1; i > 0; --i) {
      right.Add(bins[i]);
      right_cost[i] = CostOf(right);
    }
    Bin left;
    for (size_t i = 1; i < kBins; ++i) {
      left.Add(bins[i - 1]);
      if (left.triangles + left.others == 0 || right_cost[i] < 0) continue;
      const float cost = kTraversalCost + (CostOf(left) + right_cost[i]) / area;
      if (cost < best->cost) *best = {cost, axis, static_cast<int>(i)};
    }
  }
  // Negative if there are none.
  static float CostOf(const Bin& bin) {
    return bin.triangles + bin.others == 0 ? -1 : bin.bounds.SurfaceArea() * bin.Cost();
  }

  uint32_t Partition(uint32_t begin, uint32_t end, const Split& split, const Bin& all,
                     const Bounds3& centers) {
    const auto first = primitives_.begin() + begin, last = primitives_.begin() + end;
    auto middle = first + (end - begin) / 2;
    if (split.axis >= 0) {
      const Binning binning(centers, split.axis);
      middle = std::partition(first, last,
                              [&](const BoxedPrimitive& p) { return binning.BinOf(p.bounds) < split.bin; });
    } else if (all.triangles > 0 && all.others > 0) {
      middle = std::partition(first, last, [](const BoxedPrimitive& p) { return IsTriangle(p.name.kind); });
    }
    return static_cast<uint32_t>(middle - primitives_.begin());
  }

  std::span<BoxedPrimitive> primitives_;
  BinaryNode* nodes_;
  std::atomic<int> idle_threads_;
};

}  // namespace

std::unique_ptr<BinaryNode[]> BuildBinaryTree(std::span<BoxedPrimitive> primitives, int threads) {
  auto nodes = std::make_unique_for_overwrite<BinaryNode[]>(2 * primitives.size());
  TreeBuilder(primitives, nodes.get(), threads).Build(0, 0, static_cast<uint32_t>(primitives.size()), 0);
  return nodes;
}

}  // namespace tessera
