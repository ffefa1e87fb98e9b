// Triangles and rectangles as seen from a point: their solid angles, directions uniform over them, and the
// inverses. Inside, double precision with + - * / sqrt alone; angles by float functions.
#pragma once

#include "renderer/math/sampling.h"
#include "renderer/math/vec.h"
#include "renderer/shape/double3.h"
#include "renderer/shape/triangle.h"

namespace tessera {

// The part of the unit sphere around `p` that a triangle covers.
class SphericalTriangle {
 public:
  SphericalTriangle(const TrianglePoints& triangle, Point3 p);

  // Solid angle in steradians; NaN if p is a corner.
  float area() const { return area_; }
  // A direction with density 1 / area() per solid angle (Arvo 1995), not normalised to float precision. u in
  // [0,1)^2.
  Double3 Sample(Point2 u) const;
  // The u for which Sample gives this direction.
  Point2 Invert(Vec3 direction) const;

 private:
  Double3 a_, b_, c_;  // unit vectors to the corners
  double triple_;      // a . (b x c), absolute
  float area_;
};

// The part of the unit sphere around `p` that the rectangle corner + [0,1] ex + [0,1] ey covers. ex and ey
// are at right angles and not zero.
class SphericalRectangle {
 public:
  SphericalRectangle(Point3 p, Point3 corner, Vec3 ex, Vec3 ey);
  // The same in a frame at `p` whose axes are along ex and ey: the corner lies at (x, y, z), and ex and ey
  // have the lengths `width` and `height`. z >= 0.
  SphericalRectangle(double x, double y, double width, double height, double z);

  // Solid angle in steradians; 0 if p is in the rectangle's plane.
  float area() const { return area_; }
  // A place in the rectangle, in units of ex and ey, with density 1 / area() per solid angle (Urena, Fajardo,
  // King 2013). u in [0,1)^2.
  Point2 Sample(Point2 u) const;
  // The u for which Sample gives this place.
  Point2 Invert(Point2 place) const;

 private:
  float AreaUpTo(double x) const;

  double x0_, y0_, x1_, y1_, z_;  // the rectangle in a frame at p: its plane at distance z_ > 0
  float area_;
};

// Solid angle of the triangle with these corners as seen from the origin (Van Oosterom and Strackee 1983).
float SolidAngle(Double3 a, Double3 b, Double3 c);

// Weights at the corners (0,0) (1,0) (0,1) (1,1) of the unit square.
template <typename Real>
struct BilinearWeightsOf {
  Real w00{1.0f}, w10{1.0f}, w01{1.0f}, w11{1.0f};
};
using BilinearWeights = BilinearWeightsOf<float>;

// A point of the unit square with density proportional to the weights' bilinear interpolation, and that
// density.
template <typename Vector2, typename Real>
inline Vector2 SampleBilinear(Vector2 u, const BilinearWeightsOf<Real>& w) {
  const Real y = SampleLinearOf(u.y, w.w00 + w.w10, w.w01 + w.w11);
  const Real x = SampleLinearOf(u.x, Lerp(y, w.w00, w.w01), Lerp(y, w.w10, w.w11));
  return {x, y};
}
template <typename Vector2, typename Real>
inline Real BilinearPdf(Vector2 p, const BilinearWeightsOf<Real>& w) {
  const Real sum = w.w00 + w.w10 + w.w01 + w.w11;
  const Real density = Real(4.0f) * Lerp(p.y, Lerp(p.x, w.w00, w.w10), Lerp(p.x, w.w01, w.w11)) / sum;
  return Select(sum == Real(0.0f), Real(1.0f), density);
}

}  // namespace tessera
