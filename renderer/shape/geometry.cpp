#include "renderer/shape/geometry.h"

#include "renderer/shape/interaction.h"
#include "renderer/shape/quadric.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

struct CountPrimitives {
  uint32_t operator()(const TriangleMesh& mesh) const {
    return static_cast<uint32_t>(mesh.indices.size() / 3);
  }
  uint32_t operator()(const BilinearMesh& mesh) const {
    return static_cast<uint32_t>(mesh.indices.size() / 4);
  }
  uint32_t operator()(const Quadric&) const { return 1; }
};

struct BoundForm {
  template <typename Mesh>
  Bounds3 operator()(const Mesh& mesh) const {
    Bounds3 bounds;
    for (const uint32_t index : mesh.indices) bounds.Add(mesh.P[index]);
    return bounds;
  }
  Bounds3 operator()(const Quadric& quadric) const { return QuadricBounds(quadric); }
};

}  // namespace

uint32_t Shape::PrimitiveCount() const {
  return std::visit(CountPrimitives{}, form);
}

Bounds3 Shape::Bounds() const {
  return std::visit(BoundForm{}, form);
}

Bounds3 Geometry::Bounds() const {
  Bounds3 bounds;
  for (const Shape& shape : shapes) bounds.Add(shape.Bounds());
  std::vector<Bounds3> of_group(groups.size());
  for (size_t i = 0; i < groups.size(); ++i) {
    for (const Shape& shape : groups[i].shapes) of_group[i].Add(shape.Bounds());
  }
  for (const Instance& instance : instances) {
    const Bounds3& group = of_group[instance.group];
    if (!group.empty()) bounds.Add(instance.render_from_group.ToBounds(group));
  }
  return bounds;
}

uint64_t Geometry::PrimitiveCount() const {
  uint64_t count = 0;
  for (const Shape& shape : shapes) count += shape.PrimitiveCount();
  for (const ShapeGroup& group : groups) {
    for (const Shape& shape : group.shapes) count += shape.PrimitiveCount();
  }
  return count;
}

const Shape& ShapeOf(const Geometry& geometry, uint32_t instance, uint32_t shape) {
  if (instance == Hit::kNoInstance) return geometry.shapes[shape];
  return geometry.groups[geometry.instances[instance].group].shapes[shape];
}

}  // namespace tessera
