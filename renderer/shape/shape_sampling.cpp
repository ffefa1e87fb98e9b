#include "renderer/shape/shape_sampling.h"

namespace tessera {

std::optional<ShapeSample> SampleShape(const Shape& shape, uint32_t primitive,
                                       const ReferencePoint& reference, Point2 u, bool needs_uv) {
  return Dispatch(shape.form,
                  [&](const auto& form) { return form.Sample(primitive, reference, u, needs_uv); });
}

float ShapePdf(const Shape& shape, uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
               const SurfaceInteraction& on_light) {
  return Dispatch(shape.form, [&](const auto& form) { return form.Pdf(primitive, reference, wi, on_light); });
}

float ShapeArea(const Shape& shape, uint32_t primitive) {
  return Dispatch(shape.form, [&](const auto& form) { return form.Area(primitive); });
}

Bounds3 ShapeBounds(const Shape& shape, uint32_t primitive) {
  return Dispatch(shape.form, [&](const auto& form) { return form.PrimitiveBounds(primitive); });
}

NormalCone ShapeNormals(const Shape& shape, uint32_t primitive) {
  return Dispatch(shape.form, [&](const auto& form) { return form.Normals(primitive); });
}

}  // namespace tessera
