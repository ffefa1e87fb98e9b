#include "renderer/shape/shape_interaction.h"

#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

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
  const InstancePlace place(geometry, hit.instance, ray.time);
  const HitRay hit_ray{ray, place.render_from_group(), shape.surface.needs_tangents,
                       shape.surface.needs_normal_derivatives};
  SurfaceInteraction interaction;
  Dispatch(shape.form, [&](const auto& form) { form.FillInteraction(hit, hit_ray, &interaction); });
  if (hit_ray.render_from_group != nullptr) {
    TransformInteraction(*hit_ray.render_from_group, &interaction);
  }
  interaction.wo = Normalize(-ray.d);
  interaction.time = ray.time;
  const SurfaceProperties& surface = shape.surface;
  interaction.material = surface.material;
  interaction.area_light = surface.area_light < 0 ? -1 : surface.area_light + static_cast<int>(hit.primitive);
  interaction.inside_medium = surface.inside_medium;
  interaction.outside_medium = surface.outside_medium;
  interaction.hidden_from = surface.hidden_from;
  interaction.light_links = surface.light_links;
  return interaction;
}

HitPoint MakeHitPoint(const Geometry& geometry, const Hit& hit, const Ray& ray) {
  const Shape& shape = ShapeOf(geometry, hit.instance, hit.shape);
  const InstancePlace place(geometry, hit.instance, ray.time);
  const HitRay hit_ray{ray, place.render_from_group()};
  HitPoint point;
  point.p = ray.At(hit.t);
  Dispatch(shape.form, [&](const auto& form) { form.FillHitPoint(hit, hit_ray, &point); });
  if (hit_ray.render_from_group != nullptr) {
    point.n = Normalize(hit_ray.render_from_group->ToNormal(point.n));
  }
  return point;
}

}  // namespace tessera
