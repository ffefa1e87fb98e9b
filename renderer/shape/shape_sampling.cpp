#include "renderer/shape/shape_sampling.h"

#include "renderer/shape/patch_sampling.h"
#include "renderer/shape/quadric_sampling.h"
#include "renderer/shape/triangle_sampling.h"

namespace tessera {

std::optional<ShapeSample> SampleShape(const Shape& shape, uint32_t primitive,
                                       const ReferencePoint& reference, Point2 u) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form))
    return SampleTriangle(*mesh, primitive, reference, u);
  if (const auto* mesh = std::get_if<BilinearMesh>(&shape.form))
    return SamplePatch(*mesh, primitive, reference, u);
  return SampleQuadric(std::get<Quadric>(shape.form), reference, u);
}

float ShapePdf(const Shape& shape, uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
               const SurfaceInteraction& on_light) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form)) {
    return TrianglePdf(*mesh, primitive, reference, wi, on_light);
  }
  if (const auto* mesh = std::get_if<BilinearMesh>(&shape.form))
    return PatchPdf(*mesh, primitive, reference, on_light);
  return QuadricPdf(std::get<Quadric>(shape.form), reference, on_light);
}

bool SamplesNearestOnly(const Shape& shape, const ReferencePoint& reference) {
  const auto* quadric = std::get_if<Quadric>(&shape.form);
  return quadric != nullptr && SamplesByCone(*quadric, reference);
}

float ShapeArea(const Shape& shape, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form))
    return TriangleArea(TriangleAt(*mesh, primitive));
  if (const auto* mesh = std::get_if<BilinearMesh>(&shape.form)) return PatchArea(PatchAt(*mesh, primitive));
  return QuadricArea(std::get<Quadric>(shape.form));
}

Bounds3 ShapeBounds(const Shape& shape, uint32_t primitive) {
  Bounds3 bounds;
  if (const auto* triangles = std::get_if<TriangleMesh>(&shape.form)) {
    const auto [p0, p1, p2] = TriangleAt(*triangles, primitive);
    for (const Point3 p : {p0, p1, p2}) bounds.Add(p);
  } else if (const auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
    const auto [p00, p10, p01, p11] = PatchAt(*patches, primitive);
    for (const Point3 p : {p00, p10, p01, p11}) bounds.Add(p);
  } else {
    bounds = QuadricBounds(std::get<Quadric>(shape.form));
  }
  return bounds;
}

NormalCone ShapeNormals(const Shape& shape, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form)) return TriangleNormals(*mesh, primitive);
  if (const auto* mesh = std::get_if<BilinearMesh>(&shape.form)) return PatchNormals(*mesh, primitive);
  return QuadricNormals(std::get<Quadric>(shape.form));
}

}  // namespace tessera
