#include "renderer/accelerator/bvh_builder.h"

#include <array>

#include "renderer/accelerator/binary_tree.h"

namespace tessera {
namespace {

constexpr size_t kPrimitivesMax = BvhNode::kOthersMax;  // of a space; also keeps all other indices in range

// Turns a binary tree into one of wide nodes.
class Widener {
 public:
  Widener(std::span<const Shape> shapes, std::span<const BoxedPrimitive> primitives, const BinaryNode* binary,
          SearchSpace* space)
      : shapes_(shapes), primitives_(primitives), binary_(binary), space_(*space) {}

  // Returns the index of the new node.
  uint32_t AddNode(uint32_t binary_root) {
    std::array<uint32_t, BvhNode::kChildren> children;
    const int count = GatherChildren(binary_root, &children);
    const uint32_t index = static_cast<uint32_t>(space_.nodes.size());
    space_.nodes.push_back(EmptyNode());
    space_.cost += Share(binary_root) * count;
    for (int i = 0; i < count; ++i) {
      const uint32_t child = children[static_cast<size_t>(i)];
      for (int axis = 0; axis < 3; ++axis) {
        space_.nodes[index].planes[2 * axis][i] = binary_[child].bounds.min[axis];
        space_.nodes[index].planes[2 * axis + 1][i] = binary_[child].bounds.max[axis];
      }
      const uint32_t reference = binary_[child].is_leaf() ? AddLeaf(child) : AddNode(child);
      space_.nodes[index].child[i] = reference;
    }
    return index;
  }

 private:
  static BvhNode EmptyNode() {
    BvhNode node{};
    for (int i = 0; i < BvhNode::kChildren; ++i) {
      for (int plane = 0; plane < 6; ++plane) {
        const float infinity = std::numeric_limits<float>::infinity();
        node.planes[plane][i] = plane % 2 == 0 ? infinity : -infinity;
      }
    }
    return node;
  }

  // Opens the largest of the nodes gathered until there are eight or only leaves.
  int GatherChildren(uint32_t root, std::array<uint32_t, BvhNode::kChildren>* children) const {
    size_t count = 1;
    (*children)[0] = root;
    while (count < children->size()) {
      size_t largest = count;
      float area_max = -1;
      for (size_t i = 0; i < count; ++i) {
        const BinaryNode& node = binary_[(*children)[i]];
        if (node.is_leaf() || !(node.bounds.SurfaceArea() > area_max)) continue;
        area_max = node.bounds.SurfaceArea();
        largest = i;
      }
      if (largest == count) break;
      const uint32_t opened = (*children)[largest];
      (*children)[largest] = opened + 1;
      (*children)[count++] = binary_[opened].right;
    }
    return static_cast<int>(count);
  }

  uint32_t AddLeaf(uint32_t leaf) {
    const BinaryNode& node = binary_[leaf];
    const auto in_leaf = primitives_.subspan(node.begin, node.end - node.begin);
    if (IsTriangle(in_leaf[0].name.kind)) {
      space_.blocks.push_back(MakeBlock(shapes_, in_leaf));
      space_.cost += Share(leaf);
      return BvhNode::kLeaf | static_cast<uint32_t>(space_.blocks.size() - 1);
    }
    const auto first = static_cast<uint32_t>(space_.others.size());
    for (const BoxedPrimitive& other : in_leaf) space_.others.push_back({other.bounds, other.name});
    space_.cost += Share(leaf) * static_cast<double>(in_leaf.size());
    return BvhNode::kLeaf | BvhNode::kOthers | static_cast<uint32_t>(in_leaf.size()) << BvhNode::kCountShift |
           first;
  }

  // The probability that a line through the bounds of all also meets this node's.
  double Share(uint32_t node) const {
    const double all = binary_[0].bounds.SurfaceArea();
    return all > 0 ? binary_[node].bounds.SurfaceArea() / all : 1;
  }

  std::span<const Shape> shapes_;
  std::span<const BoxedPrimitive> primitives_;
  const BinaryNode* binary_;
  SearchSpace& space_;
};

}  // namespace

Result<SearchSpace> BuildBvhSpace(std::span<const Shape> shapes, std::vector<BoxedPrimitive> primitives,
                                  int threads) {
  SearchSpace space;
  if (primitives.empty()) return space;
  if (primitives.size() > kPrimitivesMax) {
    return BadInput("the accelerator \"bvh\" cannot hold more than 268435456 primitives; use \"embree\"");
  }
  const std::unique_ptr<BinaryNode[]> binary = BuildBinaryTree(primitives, threads);
  space.bounds = binary[0].bounds;
  Widener(shapes, primitives, binary.get(), &space).AddNode(0);
  return space;
}

}  // namespace tessera
