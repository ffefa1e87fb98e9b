// One bilinear patch: p(u, v) between four corners, and what the surface is like there.
#pragma once

#include "renderer/shape/double3.h"

namespace tessera {

struct PatchPoints {
  Point3 p00, p10, p01, p11;
};

// A quantity that is bilinear over the patch, from its values at the corners, and its derivatives.
template <typename T>
T Bilinear(Point2 uv, T v00, T v10, T v01, T v11) {
  return (v00 * (1 - uv.y) + v01 * uv.y) * (1 - uv.x) + (v10 * (1 - uv.y) + v11 * uv.y) * uv.x;
}
template <typename T>
T DerivativeByU(Point2 uv, T v00, T v10, T v01, T v11) {
  return (v10 * (1 - uv.y) + v11 * uv.y) - (v00 * (1 - uv.y) + v01 * uv.y);
}
template <typename T>
T DerivativeByV(Point2 uv, T v00, T v10, T v01, T v11) {
  return (v01 * (1 - uv.x) + v11 * uv.x) - (v00 * (1 - uv.x) + v10 * uv.x);
}

Point3 PatchPoint(const PatchPoints& patch, Point2 uv);
Vec3 PatchPointError(const PatchPoints& patch);
struct PatchDerivatives {
  Vec3 dpdu, dpdv;
};
PatchDerivatives DifferentiatePatch(const PatchPoints& patch, Point2 uv);
// dp/du x dp/dv, whose length is the area per (u, v) area.
inline Vec3 PatchCross(const PatchPoints& patch, Point2 uv) {
  return Cross(DerivativeByU(uv, patch.p00, patch.p10, patch.p01, patch.p11),
               DerivativeByV(uv, patch.p00, patch.p10, patch.p01, patch.p11));
}

// Whether the patch is a plane parallelogram: the fourth corner is where the other three imply it, within
// kParallelogramTolerance of the largest coordinate. The error of treating it as one is within
// PatchPointError.
constexpr float kParallelogramTolerance = 1e-6f;
bool IsParallelogram(const PatchPoints& patch);
// Whether it is a plane rectangle, by pbrt's tolerances.
bool IsRectangle(const PatchPoints& patch);

float PatchArea(const PatchPoints& patch);
// The parameters of a point on the patch, by Gauss-Newton iteration.
Point2 InvertPatch(const PatchPoints& patch, Point3 p);

}  // namespace tessera
