#include "renderer/shape/hit_refinement.h"

namespace tessera {

bool RefineHit(const Geometry& geometry, const Ray& ray, Hit* hit) {
  const Shape& shape = ShapeOf(geometry, hit->instance, hit->shape);
  const InstancePlace place(geometry, hit->instance, ray.time);
  const HitRay hit_ray{ray, place.render_from_group()};
  return Dispatch(shape.form, [&](const auto& form) { return form.Refine(hit_ray, hit); });
}

}  // namespace tessera
