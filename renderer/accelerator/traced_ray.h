// A ray in one space (of the scene, or of a group of shapes), prepared for tests against boxes and
// triangles.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderer/math/bounds.h"
#include "renderer/shape/double3.h"

namespace tessera {

// The slab test against a box uses this arithmetic everywhere: t = b / d - o / d in one
// rounding grows with the plane b, so a box inside another is entered no sooner and left no later, *in
// floats*. A ray that passes the test for a primitive's own box thus passes it for all boxes around that.
//
// Boxes are enlarged on all sides by a few rounding errors of the longest distance in the space, which
// is more than the errors of the slab test and of the triangle test together.
struct TracedRay {
  TracedRay(const DoubleRay& ray, const Bounds3& space) : exact(ray), o(ray.o.ToFloat()), d(ray.d.ToFloat()) {
    const float padding = 1e-6f * Reach(space);
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      is_negative[axis] = std::signbit(d[axis]);
      const float away = std::max(std::abs(d[axis]), kSmallestComponent);
      inverse[axis] = 1 / (is_negative[axis] ? -away : away);
      const float toward = is_negative[axis] ? -padding : padding;
      near_shift[axis] = (o[axis] + toward) * inverse[axis];
      far_shift[axis] = (o[axis] - toward) * inverse[axis];
    }
    const Vec3 size = Abs(d);
    kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    const float origin[3]{o.x, o.y, o.z}, direction[3]{d.x, d.y, d.z};
    sheared_o = {origin[kx], origin[ky], origin[kz]};
    scale_z = 1 / direction[kz];
    shear_x = direction[kx] * scale_z;
    shear_y = direction[ky] * scale_z;
  }

  // Where the ray enters a box, at least 0; false if it misses it.
  bool Enters(const Bounds3& box, float* t) const {
    float enter = 0, leave = std::numeric_limits<float>::infinity();
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const float near_plane = is_negative[axis] ? box.max[axis] : box.min[axis];
      const float far_plane = is_negative[axis] ? box.min[axis] : box.max[axis];
      enter = std::max(enter, std::fma(near_plane, inverse[axis], -near_shift[axis]));
      leave = std::min(leave, std::fma(far_plane, inverse[axis], -far_shift[axis]));
    }
    *t = enter;
    return enter <= leave;
  }

  DoubleRay exact;
  Vec3 o, d;
  Vec3 inverse, near_shift, far_shift;
  bool is_negative[3];
  // Woop's shear that makes the ray (0, 0, t); z is the axis along which d is longest.
  int kx, ky, kz;
  Point3 sheared_o;  // o with its axes exchanged in the same way
  float shear_x, shear_y, scale_z;

 private:
  static constexpr float kSmallestComponent = 1e-18f;  // of d: keeps the reciprocals finite

  float Reach(const Bounds3& space) const {
    float reach = 0;
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      reach = std::max({reach, std::abs(o[axis]), std::abs(space.min[axis] - o[axis]),
                        std::abs(space.max[axis] - o[axis])});
    }
    return reach;
  }
};

}  // namespace tessera
