#include "renderer/shape/ray_crossings.h"

#include <algorithm>

namespace tessera {
namespace {

// Finds the nearest crossing, then the nearest beyond it.
template <ShapeForm T>
int FindAll(const T& form, uint32_t primitive, const HitRay& ray, Crossing found[kCrossingsMax]) {
  const DoubleRay from_start = ray.InShapeSpace();
  const int count_max = std::min(form.CrossingsMax(primitive), kCrossingsMax);
  double skipped = 0;
  for (int count = 0; count < count_max; ++count) {
    const DoubleRay rest{from_start.At(skipped), from_start.d};
    if (!form.Intersect(primitive, rest, ray.ray.t_max - skipped, &found[count])) return count;
    found[count].t += skipped;
    skipped = found[count].t * kBeyondCrossing;
  }
  return count_max;
}

}  // namespace

int RayCrossings(const Shape& shape, const HitRay& ray, const Hit& name, Hit hits[kCrossingsMax]) {
  Crossing found[kCrossingsMax];
  const int count =
      Dispatch(shape.form, [&](const auto& form) { return FindAll(form, name.primitive, ray, found); });
  for (int i = 0; i < count; ++i) {
    hits[i] = name;
    hits[i].t = static_cast<float>(found[i].t);
    hits[i].u = found[i].u;
    hits[i].v = found[i].v;
  }
  return count;
}

}  // namespace tessera
