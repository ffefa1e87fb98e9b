#include "renderer/light/light_tree_builder.h"

#include <algorithm>
#include <array>
#include <limits>

namespace tessera {
namespace {

// One more than the split positions tried along each axis.
constexpr int kBucketCount = 12;

struct Item {
  LightBounds bounds;
  uint32_t light = 0;
};

// A node with two children, or a leaf.
struct BinaryNode {
  LightBounds bounds;
  uint32_t light = 0;
  int left = -1, right = -1;  // -1: a leaf
};

// Finds the bounds of many lights without their cones growing at each step: axes are averaged first, then the
// cone about the mean is opened until it contains them all. Add every light by AddPlace, then by AddCone.
class BoundsSum {
 public:
  bool empty() const { return count_ == 0; }
  void AddPlace(const LightBounds& b);
  void AddCone(const LightBounds& b);
  LightBounds Result() const;

 private:
  Vec3 MeanAxis() const;
  // Whether the axis is to be reversed: a two-sided emitter emits along -axis as along axis.
  bool IsFlipped(const LightBounds& b, Vec3 towards) const { return b.two_sided && Dot(b.axis, towards) < 0; }

  LightBounds sum_;
  Vec3 axis_sum_;
  int count_ = 0;
  bool same_axis_ = true;
  bool whole_sphere_ = false;
  float plane_min_ = std::numeric_limits<float>::infinity();
};

void BoundsSum::AddPlace(const LightBounds& b) {
  same_axis_ = same_axis_ && (count_ == 0 || b.axis == sum_.axis);
  if (count_ == 0) sum_.axis = b.axis;
  sum_.box.Add(b.box);
  sum_.strength += b.strength;
  sum_.cos_theta_e = count_ == 0 ? b.cos_theta_e : std::min(sum_.cos_theta_e, b.cos_theta_e);
  sum_.two_sided = sum_.two_sided || b.two_sided;
  plane_min_ = std::min(plane_min_, b.plane_min);
  axis_sum_ += IsFlipped(b, axis_sum_) ? -b.axis : b.axis;
  ++count_;
}

Vec3 BoundsSum::MeanAxis() const {
  if (same_axis_) return sum_.axis;
  const float length = Length(axis_sum_);
  return length > 0 ? axis_sum_ / length : sum_.axis;
}

void BoundsSum::AddCone(const LightBounds& b) {
  const Vec3 mean = MeanAxis();
  const float cos_between =
      std::clamp(IsFlipped(b, mean) ? -Dot(b.axis, mean) : Dot(b.axis, mean), -1.0f, 1.0f);
  // cos(between + theta_o), where that is below pi: the far rim of this cone as seen from the mean axis.
  whole_sphere_ = whole_sphere_ || cos_between < -b.cos_theta_o;
  const float cos_rim =
      b.cos_theta_o * cos_between - SafeSqrt(1 - Sqr(cos_between)) * SafeSqrt(1 - Sqr(b.cos_theta_o));
  sum_.cos_theta_o = std::min(sum_.cos_theta_o, same_axis_ ? b.cos_theta_o : cos_rim);
}

LightBounds BoundsSum::Result() const {
  LightBounds result = sum_;
  result.axis = MeanAxis();
  if (whole_sphere_ && !same_axis_) result.cos_theta_o = -1;
  if (same_axis_ && !result.two_sided) result.plane_min = plane_min_;
  return result;
}

LightBounds BoundsOf(std::span<const Item> items) {
  BoundsSum sum;
  for (const Item& item : items) sum.AddPlace(item.bounds);
  for (const Item& item : items) sum.AddCone(item.bounds);
  return sum.Result();
}

struct Split {
  int axis = -1;  // -1: none found
  int bucket = 0;
  float cost = 0;
};

class Builder {
 public:
  BuiltLightTree Build(std::vector<Item> items);

 private:
  int BuildBinary(std::span<Item> items);
  int AddLeaf(const Item& item);
  void Fold(int binary, uint32_t node);
  std::vector<int> FoldedChildren(int binary) const;

  std::vector<BinaryNode> binary_;
  BuiltLightTree result_;
};

int BucketOf(const Item& item, const Bounds3& centers, int axis) {
  const float extent = centers.max[axis] - centers.min[axis];
  const float offset = (item.bounds.box.Center()[axis] - centers.min[axis]) / extent;
  return std::clamp(static_cast<int>(offset * kBucketCount), 0, kBucketCount - 1);
}

// Replaces `best` if a split across `axis` is cheaper.
void TryAxis(std::span<const Item> items, const Bounds3& centers, float stretch, int axis, Split& best) {
  std::array<BoundsSum, kBucketCount> buckets;
  for (const Item& item : items) buckets[BucketOf(item, centers, axis)].AddPlace(item.bounds);
  for (const Item& item : items) buckets[BucketOf(item, centers, axis)].AddCone(item.bounds);
  std::array<float, kBucketCount> cost_above{};  // [i]: of buckets i, i + 1, ...
  LightBounds above;
  for (int i = kBucketCount - 1; i > 0; --i) {
    if (buckets[i].empty()) {
      cost_above[i] = i + 1 < kBucketCount ? cost_above[i + 1] : 0;
      continue;
    }
    above = Union(above, buckets[i].Result());
    cost_above[i] = ClusterCost(above);
  }
  LightBounds below;
  for (int i = 0; i + 1 < kBucketCount; ++i) {
    if (buckets[i].empty()) continue;  // the same split as before
    below = Union(below, buckets[i].Result());
    const float cost = (ClusterCost(below) + cost_above[i + 1]) * stretch;
    if (best.axis < 0 || cost < best.cost) best = {axis, i, cost};
  }
}

// Reorders `items` and returns the number that go to the left.
size_t SplitItems(std::span<Item> items) {
  if (items.size() == 2) return 1;
  Bounds3 centers, box;
  for (const Item& item : items) {
    centers.Add(item.bounds.box.Center());
    box.Add(item.bounds.box);
  }
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centers.max[axis] > centers.min[axis])) continue;
    // Prefers to split long thin clusters across their length.
    const float stretch = MaxComponent(box.Diagonal()) / box.Diagonal()[axis];
    TryAxis(items, centers, stretch, axis, best);
  }
  if (best.axis < 0) return items.size() / 2;
  const auto middle = std::stable_partition(items.begin(), items.end(), [&](const Item& item) {
    return BucketOf(item, centers, best.axis) <= best.bucket;
  });
  const size_t left = static_cast<size_t>(middle - items.begin());
  return left == 0 || left == items.size() ? items.size() / 2 : left;
}

int Builder::AddLeaf(const Item& item) {
  binary_.push_back({item.bounds, item.light, -1, -1});
  return static_cast<int>(binary_.size() - 1);
}

int Builder::BuildBinary(std::span<Item> items) {
  if (items.size() == 1) return AddLeaf(items[0]);
  const LightBounds bounds = BoundsOf(items);
  const size_t middle = SplitItems(items);
  const int left = BuildBinary(items.first(middle));
  const int right = BuildBinary(items.subspan(middle));
  binary_.push_back({bounds, 0, left, right});
  return static_cast<int>(binary_.size() - 1);
}

// Replaces the costliest node below `binary` by its children until there are four or only leaves are left.
std::vector<int> Builder::FoldedChildren(int binary) const {
  if (binary_[binary].left < 0) return {binary};
  std::vector<int> children = {binary_[binary].left, binary_[binary].right};
  while (children.size() < 4) {
    int costliest = -1;
    float cost_max = -1;
    for (size_t i = 0; i < children.size(); ++i) {
      const BinaryNode& child = binary_[children[i]];
      const float cost = ClusterCost(child.bounds);
      if (child.left >= 0 && cost > cost_max) {
        costliest = static_cast<int>(i);
        cost_max = cost;
      }
    }
    if (costliest < 0) break;
    const BinaryNode& opened = binary_[children[costliest]];
    children[costliest] = opened.left;
    children.insert(children.begin() + costliest + 1, opened.right);
  }
  return children;
}

void Builder::Fold(int binary, uint32_t node) {
  const std::vector<int> children = FoldedChildren(binary);
  for (size_t slot = 0; slot < children.size(); ++slot) {
    const BinaryNode& child = binary_[children[slot]];
    if (child.left < 0) {
      result_.nodes[node].SetChild(static_cast<int>(slot), child.bounds, LightTreeNode::kLeaf | child.light);
      continue;
    }
    const uint32_t index = static_cast<uint32_t>(result_.nodes.size());
    result_.nodes.emplace_back();
    result_.nodes[node].SetChild(static_cast<int>(slot), child.bounds, index);
    Fold(children[slot], index);
  }
}

BuiltLightTree Builder::Build(std::vector<Item> items) {
  if (items.empty()) return {};
  binary_.reserve(2 * items.size());
  const int root = BuildBinary(items);
  result_.nodes.emplace_back();
  Fold(root, 0);
  return std::move(result_);
}

}  // namespace

BuiltLightTree BuildLightTree(std::span<const LightBounds> bounds, std::span<const uint32_t> lights) {
  std::vector<Item> items;
  for (size_t i = 0; i < bounds.size(); ++i) {
    if (bounds[i].strength > 0) items.push_back({bounds[i], lights[i]});
  }
  return Builder().Build(std::move(items));
}

}  // namespace tessera
