// Rays of several lanes, and where they start. Every function has the bits of that of one ray (ray.h), lane
// by lane.
#pragma once

#include <cstddef>

#include "renderer/math/lanes.h"
#include "renderer/math/ray.h"

namespace tessera {

struct Rays8 {
  Vec3x8 o, d;
  Float8 t_max, time;

  // The rays of `lanes`; the other lanes repeat one of them.
  Rays8(LaneSet lanes, const Ray* const* rays) {
    static_assert(offsetof(Ray, d) == 3 * sizeof(float) && offsetof(Ray, t_max) == 6 * sizeof(float) &&
                  offsetof(Ray, time) == 7 * sizeof(float));
    const int first = std::countr_zero(lanes);
    __m128 front[kLanes], back[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      const float* const row = &rays[HasLane(lanes, lane) ? lane : first]->o.x;
      front[lane] = _mm_loadu_ps(row);
      back[lane] = _mm_loadu_ps(row + 4);
    }
    const Rows8 low = Transpose(front), high = Transpose(back);
    o = {low.a, low.b, low.c};
    d = {low.d, high.a, high.b};
    t_max = high.c;
    time = high.d;
  }
  Rays8(Vec3x8 origin, Vec3x8 direction, Float8 end, Float8 seconds)
      : o(origin), d(direction), t_max(end), time(seconds) {}

  // Stores the ray of each of `lanes` into *place(lane).
  template <typename Place>
  void Store(LaneSet lanes, Place&& place) const {
    const Quads low = Untranspose(o.x, o.y, o.z, d.x), high = Untranspose(d.y, d.z, t_max, time);
    ForEachLane(lanes, [&](int lane) {
      float* const row = &place(lane)->o.x;
      _mm_storeu_ps(row, low.lane[lane]);
      _mm_storeu_ps(row + 4, high.lane[lane]);
    });
  }
};

inline Vec3x8 OffsetRayOrigin(Vec3x8 p, Vec3x8 error, Vec3x8 n, Vec3x8 w) {
  const Float8 d = NegateWhere(Dot(w, n) < Float8(0.0f), Dot(Abs(n), error));
  const auto offset = [d](Float8 at, Float8 normal) {
    const Float8 by = normal * d;
    const Float8 moved = at + by;
    // The next float in the direction of the offset: NextFloatUp with the sign of the offset.
    const __m256 sign = _mm256_and_ps(by.v, _mm256_set1_ps(-0.0f));
    const __m256 along = _mm256_xor_ps(moved.v, sign), zero = _mm256_setzero_ps();
    const __m256i is_positive = _mm256_castps_si256(_mm256_cmp_ps(along, zero, _CMP_GT_OQ));
    const __m256i step = _mm256_sub_epi32(_mm256_set1_epi32(-1), _mm256_add_epi32(is_positive, is_positive));
    __m256 next = _mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(along), step));
    next = _mm256_blendv_ps(next, _mm256_set1_ps(std::numeric_limits<float>::denorm_min()),
                            _mm256_cmp_ps(along, zero, _CMP_EQ_OQ));
    const __m256 is_finite =
        _mm256_cmp_ps(along, _mm256_set1_ps(std::numeric_limits<float>::infinity()), _CMP_LT_OQ);
    const __m256 is_moved = _mm256_and_ps(is_finite, _mm256_cmp_ps(by.v, zero, _CMP_NEQ_OQ));
    return Float8(_mm256_blendv_ps(moved.v, _mm256_xor_ps(next, sign), is_moved));
  };
  return {offset(p.x, n.x), offset(p.y, n.y), offset(p.z, n.z)};
}

}  // namespace tessera
