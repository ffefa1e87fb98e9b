#include "renderer/shape/ray_crossings.h"

#include "renderer/shape/patch_intersection.h"
#include "renderer/shape/quadric_intersection.h"
#include "renderer/shape/triangle.h"

namespace tessera {
namespace {

// Where the search for a second crossing begins, relative to the distance of the first: well above the
// rounding of doubles, well below that of the rays' own floats.
constexpr double kBeyond = 1 + 1e-9;

struct Crossing {
  double t = 0;
  float u = 0, v = 0;
};

bool FindTriangle(const TrianglePoints& triangle, const DoubleRay& ray, double t_max, Crossing* found) {
  TriangleCrossing c;
  if (!CrossTriangle(triangle, ray, &c)) return false;
  if (!(c.t > 0 && c.t <= t_max && c.u >= 0 && c.v >= 0 && c.u + c.v <= 1)) return false;
  *found = {c.t, static_cast<float>(c.u), static_cast<float>(c.v)};
  return true;
}

bool FindPatch(const PatchPoints& patch, const DoubleRay& ray, double t_max, Crossing* found) {
  PatchHit hit;
  if (!IntersectPatch(patch, ray, t_max, &hit)) return false;
  *found = {hit.t, hit.u, hit.v};
  return true;
}

bool FindQuadric(const Quadric& quadric, const DoubleRay& ray, double t_max, Crossing* found) {
  return IntersectQuadric(quadric, ray, t_max, &found->t);
}

// Asks `find` for the nearest crossing, then for the nearest beyond it.
template <typename Find>
int FindAll(const Ray& ray, int count_max, const Find& find, Crossing found[kCrossingsMax]) {
  const DoubleRay from_start{Double3(ray.o), Double3(ray.d)};
  double skipped = 0;
  for (int count = 0; count < count_max; ++count) {
    const DoubleRay rest{from_start.At(skipped), from_start.d};
    if (!find(rest, ray.t_max - skipped, &found[count])) return count;
    found[count].t += skipped;
    skipped = found[count].t * kBeyond;
  }
  return count_max;
}

int FindInShape(const Shape& shape, uint32_t primitive, const Ray& ray, Crossing found[kCrossingsMax]) {
  if (const auto* triangles = std::get_if<TriangleMesh>(&shape.form)) {
    const TrianglePoints triangle = TriangleAt(*triangles, primitive);
    return FindAll(
        ray, 1,
        [&](const DoubleRay& r, double t_max, Crossing* c) { return FindTriangle(triangle, r, t_max, c); },
        found);
  }
  if (const auto* patches = std::get_if<BilinearMesh>(&shape.form)) {
    const PatchPoints patch = PatchAt(*patches, primitive);
    return FindAll(
        ray, IsRectangle(patch) ? 1 : 2,
        [&](const DoubleRay& r, double t_max, Crossing* c) { return FindPatch(patch, r, t_max, c); }, found);
  }
  const Quadric& quadric = std::get<Quadric>(shape.form);
  return FindAll(
      ray, quadric.kind == Quadric::Kind::kDisk ? 1 : 2,
      [&](const DoubleRay& r, double t_max, Crossing* c) { return FindQuadric(quadric, r, t_max, c); },
      found);
}

}  // namespace

int RayCrossings(const Shape& shape, uint32_t shape_index, uint32_t primitive, const Ray& ray,
                 Hit hits[kCrossingsMax]) {
  Crossing found[kCrossingsMax];
  const int count = FindInShape(shape, primitive, ray, found);
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
