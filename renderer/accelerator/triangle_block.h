// Tests eight triangles against a ray in one go.
//
// The test is that of Woop, Benthin and Wald 2013 ("Watertight Ray/Triangle Intersection") and not Moeller
// and Trumbore's of 1997, which computes an edge that two triangles share in two different ways: rays can
// slip through between them. Here every vertex is sheared into the ray's space by itself, so both triangles
// see the same two points, and the edge's function a x b is the difference of two rounded products, which
// changes only its sign when a and b are exchanged. As rounding is monotonic, that sign is never wrong; it
// can only become zero, which counts as inside for both. So no ray passes a shared edge or vertex. (The
// original switches to double precision at zero to assign the edge to one side; here the order of primitives
// decides.)
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "renderer/accelerator/traced_ray.h"
#include "renderer/shape/triangle.h"

namespace tessera {

struct alignas(32) TriangleBlock {
  static constexpr int kLanes = 8;

  float p[3][3][kLanes];  // vertex, axis, lane
  uint32_t shape[kLanes];
  uint32_t primitive[kLanes];
  // One bit for each lane.
  uint8_t used = 0;
  uint8_t with_alpha = 0;
  uint8_t passed_by_shadow_rays = 0;
  uint8_t of_patches = 0;  // half of a patch that is a parallelogram

  TrianglePoints Triangle(int lane) const { return {Vertex(0, lane), Vertex(1, lane), Vertex(2, lane)}; }

 private:
  Point3 Vertex(int i, int lane) const { return {p[i][0][lane], p[i][1][lane], p[i][2][lane]}; }
};

// A block's vertices as the sheared ray sees them.
struct ShearedVertices {
  __m256 x[3], y[3], z[3];
};

inline ShearedVertices Shear(const TriangleBlock& block, const TracedRay& ray) {
  ShearedVertices sheared;
  const __m256 ox = _mm256_set1_ps(ray.sheared_o.x), oy = _mm256_set1_ps(ray.sheared_o.y),
               oz = _mm256_set1_ps(ray.sheared_o.z);
  const __m256 sx = _mm256_set1_ps(ray.shear_x), sy = _mm256_set1_ps(ray.shear_y);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    sheared.z[i] = _mm256_sub_ps(_mm256_load_ps(block.p[i][ray.kz]), oz);
    sheared.x[i] = _mm256_fnmadd_ps(sx, sheared.z[i], _mm256_sub_ps(_mm256_load_ps(block.p[i][ray.kx]), ox));
    sheared.y[i] = _mm256_fnmadd_ps(sy, sheared.z[i], _mm256_sub_ps(_mm256_load_ps(block.p[i][ray.ky]), oy));
  }
  return sheared;
}

// The lanes, one bit each, whose triangle the ray's line crosses, without those that lie wholly before the
// start of the ray or beyond t_limit. Writes the nearest vertex of each, in units of t, to `nearest`; its
// other elements are unspecified.
inline unsigned CrossedLanes(const TriangleBlock& block, const TracedRay& ray, float t_limit,
                             float nearest[TriangleBlock::kLanes]) {
  const auto [x, y, z] = Shear(block, ray);
  const auto edge = [&x = x, &y = y](int a, int b) {
    return _mm256_sub_ps(_mm256_mul_ps(x[a], y[b]), _mm256_mul_ps(y[a], x[b]));
  };
  const __m256 u = edge(2, 1), v = edge(0, 2), w = edge(1, 0), zero = _mm256_setzero_ps();
  const __m256 least = _mm256_min_ps(_mm256_min_ps(u, v), w);
  const __m256 most = _mm256_max_ps(_mm256_max_ps(u, v), w);
  const __m256 inside =
      _mm256_or_ps(_mm256_cmp_ps(least, zero, _CMP_GE_OQ), _mm256_cmp_ps(most, zero, _CMP_LE_OQ));
  const __m256 has_area = _mm256_cmp_ps(least, most, _CMP_NEQ_OQ);
  const __m256 is_centered = _mm256_cmp_ps(most, zero, _CMP_NEQ_OQ);  // three equal edge functions, not zero
  unsigned lanes =
      static_cast<unsigned>(_mm256_movemask_ps(_mm256_and_ps(inside, _mm256_or_ps(has_area, is_centered))));
  lanes &= block.used;
  if (lanes == 0) return 0;
  const __m256 scale = _mm256_set1_ps(ray.scale_z);
  const __m256 t0 = _mm256_mul_ps(z[0], scale), t1 = _mm256_mul_ps(z[1], scale),
               t2 = _mm256_mul_ps(z[2], scale);
  const __m256 first = _mm256_min_ps(_mm256_min_ps(t0, t1), t2);
  const __m256 last = _mm256_max_ps(_mm256_max_ps(t0, t1), t2);
  const __m256 in_range = _mm256_and_ps(_mm256_cmp_ps(first, _mm256_set1_ps(t_limit), _CMP_LE_OQ),
                                        _mm256_cmp_ps(last, zero, _CMP_GE_OQ));
  _mm256_store_ps(nearest, first);
  return lanes & static_cast<unsigned>(_mm256_movemask_ps(in_range));
}

}  // namespace tessera
