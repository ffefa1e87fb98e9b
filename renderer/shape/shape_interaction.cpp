#include "renderer/shape/shape_interaction.h"

#include "renderer/shape/hit_refinement.h"
#include "renderer/shape/patch.h"
#include "renderer/shape/quadric.h"
#include "renderer/shape/shading_geometry.h"
#include "renderer/shape/triangle.h"

namespace tessera {
namespace {

// The hit in the object space of a quadric.
Double3 ObjectPoint(const Quadric& quadric, const Geometry& geometry, const Hit& hit, const Ray& ray) {
  const DoubleRay in_shape_space = RayInShapeSpace(geometry, hit.instance, ray);
  return TransformPoint(quadric.render_from_object.inverse_matrix(), in_shape_space.At(hit.t));
}

// From a group's space to rendering space.
void TransformInteraction(const Transform& transform, SurfaceInteraction* interaction) {
  const PointWithError point =
      TransformPointWithError(transform, Double3(interaction->p), interaction->p_error);
  interaction->p = point.p;
  interaction->p_error = point.error;
  interaction->n = Normalize(transform.ToNormal(interaction->n));
  interaction->dpdu = transform.ToVector(interaction->dpdu);
  interaction->dpdv = transform.ToVector(interaction->dpdv);
  SurfaceInteraction::Shading& shading = interaction->shading;
  shading.n = FaceForward(Normalize(transform.ToNormal(shading.n)), interaction->n);
  shading.dpdu = transform.ToVector(shading.dpdu);
  shading.dpdv = transform.ToVector(shading.dpdv);
  shading.dndu = transform.ToNormal(shading.dndu);
  shading.dndv = transform.ToNormal(shading.dndv);
}

}  // namespace

SurfaceInteraction MakeInteraction(const Geometry& geometry, const Hit& hit, const Ray& ray) {
  const Shape& shape = ShapeOf(geometry, hit.instance, hit.shape);
  SurfaceInteraction interaction;
  if (const auto* triangles = std::get_if<TriangleMesh>(&shape.form)) {
    FillTriangleInteraction(*triangles, hit.primitive, hit.u, hit.v, &interaction);
  } else if (const auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
    FillPatchInteraction(*patches, hit.primitive, {hit.u, hit.v}, &interaction);
  } else if (const auto* quadric = std::get_if<Quadric>(&shape.form)) {
    FillQuadricInteraction(*quadric, ObjectPoint(*quadric, geometry, hit, ray), &interaction);
  }
  if (hit.instance != Hit::kNoInstance) {
    TransformInteraction(geometry.instances[hit.instance].render_from_group, &interaction);
  }
  interaction.wo = Normalize(-ray.d);
  interaction.time = ray.time;
  const SurfaceProperties& surface = shape.surface;
  interaction.material = surface.material;
  interaction.area_light = surface.area_light < 0 ? -1 : surface.area_light + static_cast<int>(hit.primitive);
  interaction.inside_medium = surface.inside_medium;
  interaction.outside_medium = surface.outside_medium;
  return interaction;
}

HitPoint MakeHitPoint(const Geometry& geometry, const Hit& hit, const Ray& ray) {
  const Shape& shape = ShapeOf(geometry, hit.instance, hit.shape);
  HitPoint point;
  point.p = ray.At(hit.t);
  if (const auto* triangles = std::get_if<TriangleMesh>(&shape.form)) {
    const TrianglePoints triangle = TriangleAt(*triangles, hit.primitive);
    point.uv = TriangleTextureCoordinates(*triangles, hit.primitive, hit.u, hit.v);
    point.n = TriangleNormal(*triangles, hit.primitive, triangle, hit.u, hit.v);
  } else if (const auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
    const Point2 uv{hit.u, hit.v};
    point.uv = PatchTextureCoordinates(*patches, hit.primitive, uv);
    point.n = PatchNormal(*patches, hit.primitive, PatchAt(*patches, hit.primitive), uv);
  } else if (const auto* quadric = std::get_if<Quadric>(&shape.form)) {
    const Point3 p = ProjectToQuadric(*quadric, ObjectPoint(*quadric, geometry, hit, ray)).ToFloat();
    point.uv = QuadricUv(*quadric, p);
    point.n = QuadricNormal(*quadric, p);
  }
  if (hit.instance != Hit::kNoInstance) {
    point.n = Normalize(geometry.instances[hit.instance].render_from_group.ToNormal(point.n));
  }
  return point;
}

}  // namespace tessera
