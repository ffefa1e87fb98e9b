#include "renderer/shape/hit_refinement.h"

#include <algorithm>

#include "renderer/shape/patch_intersection.h"
#include "renderer/shape/triangle.h"

namespace tessera {
namespace {

bool RefineTriangle(const TriangleMesh& mesh, const DoubleRay& ray, double t_max, Hit* hit) {
  TriangleCrossing crossing;
  if (!CrossTriangle(TriangleAt(mesh, hit->primitive), ray, &crossing)) return true;  // seen edge on: keep it
  if (!(crossing.t > 0)) return false;
  const double u = std::clamp(crossing.u, 0.0, 1.0);
  hit->t = static_cast<float>(std::min(crossing.t, t_max));
  hit->u = static_cast<float>(u);
  hit->v = static_cast<float>(std::clamp(crossing.v, 0.0, 1 - u));
  return true;
}

bool RefinePatch(const BilinearMesh& mesh, const DoubleRay& ray, double t_max, Hit* hit) {
  const PatchPoints patch = PatchAt(mesh, hit->primitive);
  PatchHit refined;
  if (!IsParallelogram(patch) || !CrossParallelogram(patch, ray, &refined)) return true;
  if (!(refined.t > 0)) return false;
  hit->t = static_cast<float>(std::min(refined.t, t_max));
  hit->u = refined.u;
  hit->v = refined.v;
  return true;
}

}  // namespace

DoubleRay RayInShapeSpace(const Geometry& geometry, uint32_t instance, const Ray& ray) {
  const DoubleRay exact{Double3(ray.o), Double3(ray.d)};
  if (instance == Hit::kNoInstance) return exact;
  return exact.TransformedBy(geometry.instances[instance].render_from_group.inverse_matrix());
}

bool RefineHit(const Geometry& geometry, const Ray& ray, Hit* hit) {
  const Shape& shape = ShapeOf(geometry, hit->instance, hit->shape);
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape.form)) {
    return RefineTriangle(*mesh, RayInShapeSpace(geometry, hit->instance, ray), ray.t_max, hit);
  }
  if (const auto* mesh = std::get_if<BilinearMesh>(&shape.form)) {
    return RefinePatch(*mesh, RayInShapeSpace(geometry, hit->instance, ray), ray.t_max, hit);
  }
  return true;
}

}  // namespace tessera
