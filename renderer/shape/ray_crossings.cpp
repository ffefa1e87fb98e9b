#include "renderer/shape/ray_crossings.h"

#include <algorithm>

namespace tessera {
namespace {

// Finds the nearest crossing, then the nearest beyond it.
template <ShapeForm T>
int FindAll(const T& form, uint32_t primitive, const Ray& ray, Crossing found[kCrossingsMax]) {
  const DoubleRay from_start{Double3(ray.o), Double3(ray.d)};
  const int count_max = std::min(form.CrossingsMax(primitive), kCrossingsMax);
  double skipped = 0;
  for (int count = 0; count < count_max; ++count) {
    const DoubleRay rest{from_start.At(skipped), from_start.d};
    if (!form.Intersect(primitive, rest, ray.t_max - skipped, &found[count])) return count;
    found[count].t += skipped;
    skipped = found[count].t * kBeyondCrossing;
  }
  return count_max;
}

}  // namespace

int RayCrossings(const Shape& shape, uint32_t shape_index, uint32_t primitive, const Ray& ray,
                 Hit hits[kCrossingsMax]) {
  Crossing found[kCrossingsMax];
  const int count =
      Dispatch(shape.form, [&](const auto& form) { return FindAll(form, primitive, ray, found); });
  for (int i = 0; i < count; ++i) {
    hits[i] = {};
    hits[i].t = static_cast<float>(found[i].t);
    hits[i].u = found[i].u;
    hits[i].v = found[i].v;
    hits[i].shape = shape_index;
    hits[i].primitive = primitive;
  }
  return count;
}

}  // namespace tessera
