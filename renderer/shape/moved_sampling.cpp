#include "renderer/shape/moved_sampling.h"

#include <cmath>

#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

Normal3 UnitOrZero(Normal3 n) {
  const float length = Length(n);
  return length > 0 ? n / length : Normal3{};
}

// Of the linear part, in double: the product of three small scales does not underflow.
double LinearDeterminant(const Matrix4& matrix) {
  const auto& m = matrix.m;
  const auto minor = [&](int row0, int row1) {
    return static_cast<double>(m[row0][0]) * m[row1][1] - static_cast<double>(m[row0][1]) * m[row1][0];
  };
  return m[0][2] * minor(1, 2) - m[1][2] * minor(0, 2) + m[2][2] * minor(0, 1);
}

}  // namespace

ReferencePoint MoveReference(const Transform& render_from_space, const ReferencePoint& reference) {
  const Transform space_from_render = render_from_space.Inverse();
  const PointWithError point =
      TransformPointWithError(space_from_render, Double3(reference.p), reference.p_error);
  return {point.p, point.error, UnitOrZero(space_from_render.ToNormal(reference.n)),
          UnitOrZero(space_from_render.ToNormal(reference.shading_n)), reference.time};
}

// The linear map A of space onto rendering space takes a cone of directions of solid angle dw about w to one
// of |det A| / |A w|^3 dw about A w / |A w|. Here from the other side, with the inverse of A.
float SolidAngleRatio(const Transform& render_from_space, Vec3 wi) {
  const double determinant = std::abs(LinearDeterminant(render_from_space.inverse_matrix()));
  const double length = Length(render_from_space.Inverse().ToVector(wi));
  const double ratio = determinant / (length * length * length);
  return std::isfinite(ratio) ? static_cast<float>(ratio) : 0;
}

std::optional<ShapeSample> SampleMovedShape(const Shape& shape, uint32_t primitive,
                                            const Transform& render_from_shape,
                                            const ReferencePoint& reference, Point2 u) {
  std::optional<ShapeSample> sample =
      SampleShape(shape, primitive, MoveReference(render_from_shape, reference), u);
  if (!sample) return std::nullopt;
  const PointWithError point =
      TransformPointWithError(render_from_shape, Double3(sample->p), sample->p_error);
  sample->p = point.p;
  sample->p_error = point.error;
  sample->n = UnitOrZero(render_from_shape.ToNormal(sample->n));
  sample->pdf *= SolidAngleRatio(render_from_shape, UnitOrZero(sample->p - reference.p));
  return sample;
}

float MovedShapePdf(const Shape& shape, uint32_t primitive, const Transform& render_from_shape,
                    const ReferencePoint& reference, Vec3 wi, const SurfaceInteraction& on_light) {
  const Transform shape_from_render = render_from_shape.Inverse();
  SurfaceInteraction there = on_light;
  there.p = shape_from_render.ToPoint(on_light.p);
  there.n = UnitOrZero(shape_from_render.ToNormal(on_light.n));
  const float pdf = ShapePdf(shape, primitive, MoveReference(render_from_shape, reference),
                             UnitOrZero(shape_from_render.ToVector(wi)), there);
  return pdf * SolidAngleRatio(render_from_shape, wi);
}

// A map A makes |det A| |A^-T n| of the area of a plane with the normal n.
std::optional<float> MovedShapeArea(const Shape& shape, uint32_t primitive,
                                    const Transform& render_from_shape) {
  constexpr float kTolerance = 1e-4f;
  const float area = ShapeArea(shape, primitive);
  const double determinant = std::abs(LinearDeterminant(render_from_shape.matrix()));
  const NormalCone normals = ShapeNormals(shape, primitive);
  const auto factor = [&](Vec3 n) {
    return static_cast<float>(determinant * static_cast<double>(Length(render_from_shape.ToNormal(n))));
  };
  if (normals.cos_angle >= 1) return area * factor(normals.axis);
  const float even = factor({1, 0, 0});
  for (const Vec3 n : {Vec3{0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}) {
    if (std::abs(factor(Normalize(n)) - even) > kTolerance * even) return std::nullopt;
  }
  return area * even;
}

}  // namespace tessera
