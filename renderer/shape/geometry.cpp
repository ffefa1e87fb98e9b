#include "renderer/shape/geometry.h"

namespace tessera {

uint32_t Shape::PrimitiveCount() const {
  return Dispatch(form, [](const auto& f) { return f.PrimitiveCount(); });
}

uint64_t Shape::Bytes() const {
  return Dispatch(form, [](const auto& f) { return f.Bytes(); });
}

Bounds3 Shape::Bounds() const {
  return Dispatch(form, [](const auto& f) {
    Bounds3 bounds;
    const uint32_t count = f.PrimitiveCount();
    for (uint32_t i = 0; i < count; ++i) bounds.Add(f.PrimitiveBounds(i));
    return bounds;
  });
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
    if (!group.empty()) bounds.Add(InstanceBounds(instance, group));
  }
  return bounds;
}

Bounds3 Geometry::InstanceBounds(const Instance& instance, const Bounds3& group) const {
  if (instance.motion < 0) return instance.render_from_group.ToBounds(group);
  return motions[static_cast<size_t>(instance.motion)].BoundsOf(group, times.start, times.end);
}

uint64_t Geometry::PrimitiveCount() const {
  uint64_t count = 0;
  for (const Shape& shape : shapes) count += shape.PrimitiveCount();
  for (const ShapeGroup& group : groups) {
    for (const Shape& shape : group.shapes) count += shape.PrimitiveCount();
  }
  return count;
}

}  // namespace tessera
