#include "renderer/shape/spherical_sampling.h"

#include <algorithm>

namespace tessera {
namespace {

double Length(Double3 a) {
  return std::sqrt(Dot(a, a));
}
Double3 Unit(Double3 a) {
  return a * (1 / Length(a));
}
// The part of v at right angles to unit `axis`, as a unit vector.
Double3 UnitAcross(Double3 v, Double3 axis) {
  return Unit(v - axis * Dot(v, axis));
}
// 1 - cos of the angle between unit vectors, without cancellation.
double OneMinusCosine(Double3 a, Double3 b) {
  return Dot(a - b, a - b) / 2;
}

float ClampToUnit(double v) {
  return std::clamp(static_cast<float>(v), 0.0f, 1.0f);
}

}  // namespace

float SolidAngle(Double3 a, Double3 b, Double3 c) {
  const double la = Length(a), lb = Length(b), lc = Length(c);
  const double numerator = std::abs(Dot(a, Cross(b, c)));
  const double denominator = la * lb * lc + Dot(a, b) * lc + Dot(a, c) * lb + Dot(b, c) * la;
  // Scaled, so that neither is lost in the range of float.
  const double scale = 1 / (la * lb * lc);
  return 2 * std::atan2(static_cast<float>(numerator * scale), static_cast<float>(denominator * scale));
}

SphericalTriangle::SphericalTriangle(const TrianglePoints& triangle, Point3 p)
    : a_(Unit(Difference(triangle.p0, p))),
      b_(Unit(Difference(triangle.p1, p))),
      c_(Unit(Difference(triangle.p2, p))),
      triple_(std::abs(Dot(a_, Cross(b_, c_)))),
      area_(SolidAngle(a_, b_, c_)) {}

Double3 SphericalTriangle::Sample(Point2 u) const {
  // The angle alpha at corner a, between the arcs to b and c.
  const Double3 n_ab = Cross(a_, b_), n_ac = Cross(a_, c_);
  const double scale = 1 / std::sqrt(Dot(n_ab, n_ab) * Dot(n_ac, n_ac));
  const double cos_alpha = Dot(n_ab, n_ac) * scale;
  const double sin_alpha = triple_ * scale;
  // The part of the area to cover, A'. By half angles, so that 1 - cos A' keeps its precision.
  const float half = u.x * area_ / 2;
  const double sin_half = std::sin(half);
  const double cos_half = std::cos(half);
  const double sin_area = 2 * sin_half * cos_half;
  const double one_minus_cos_area = 2 * sin_half * sin_half;
  // Arvo's equations with s = sin(A' - alpha), t = cos(A' - alpha).
  const double k1 = sin_alpha * sin_area - cos_alpha * one_minus_cos_area;  // t - cos(alpha)
  const double k2 =
      sin_area * cos_alpha + one_minus_cos_area * sin_alpha - sin_alpha * OneMinusCosine(a_, b_);
  const double s = sin_area * cos_alpha - (1 - one_minus_cos_area) * sin_alpha;
  const double t = cos_alpha + k1;
  const double q = ((k2 * t - k1 * s) * cos_alpha - k2) / ((k2 * s + k1 * t) * sin_alpha);
  const double cosine = q >= -1 ? std::min(q, 1.0) : -1.0;  // NaN: the far end
  const Double3 c_part = a_ * cosine + UnitAcross(c_, a_) * std::sqrt((1 - cosine) * (1 + cosine));
  const double one_minus_z = u.y * OneMinusCosine(c_part, b_);
  const double sine = std::sqrt(std::max(0.0, one_minus_z * (2 - one_minus_z)));
  return sine > 0 ? b_ * (1 - one_minus_z) + UnitAcross(c_part, b_) * sine : b_;
}

Point2 SphericalTriangle::Invert(Vec3 direction) const {
  const Double3 w = Unit(Double3(direction));
  const double from_b = OneMinusCosine(w, b_);
  // c' is where the great circle through b and w meets the one through a and c.
  Double3 c_part = Cross(Cross(b_, w), Cross(c_, a_));
  if (!(Dot(c_part, c_part) > 0)) return {0, 0};
  c_part = Unit(c_part);
  if (Dot(c_part, a_ + c_) < 0) c_part = c_part * -1;
  const float part = SolidAngle(a_, b_, c_part);
  return {ClampToUnit(part / area_), ClampToUnit(from_b / OneMinusCosine(c_part, b_))};
}

SphericalRectangle::SphericalRectangle(double x, double y, double width, double height, double z)
    : x0_(x), y0_(y), x1_(x + width), y1_(y + height), z_(z), area_(z > 0 ? AreaUpTo(x1_) : 0) {}

SphericalRectangle::SphericalRectangle(Point3 p, Point3 corner, Vec3 ex, Vec3 ey) {
  const Double3 x_axis(ex), y_axis(ey);
  const double x_length = Length(x_axis), y_length = Length(y_axis);
  const Double3 to_corner = Difference(corner, p);
  const double z = std::abs(Dot(to_corner, Unit(Cross(x_axis, y_axis))));
  *this = SphericalRectangle(Dot(to_corner, x_axis) / x_length, Dot(to_corner, y_axis) / y_length, x_length,
                             y_length, z);
}

// Solid angle of the part left of x. It is that of two triangles with a common diagonal; each has half the
// angle of a complex number (Van Oosterom and Strackee 1983), and their product has the sum of both.
float SphericalRectangle::AreaUpTo(double x) const {
  const double zz = z_ * z_;
  const double l00 = std::sqrt(x0_ * x0_ + y0_ * y0_ + zz), l10 = std::sqrt(x * x + y0_ * y0_ + zz);
  const double l01 = std::sqrt(x0_ * x0_ + y1_ * y1_ + zz), l11 = std::sqrt(x * x + y1_ * y1_ + zz);
  const double bottom = x0_ * x + y0_ * y0_ + zz, top = x0_ * x + y1_ * y1_ + zz;
  const double left = x0_ * x0_ + y0_ * y1_ + zz, right = x * x + y0_ * y1_ + zz;
  const double diagonal = x0_ * x + y0_ * y1_ + zz;
  // Scaled, so that neither is lost in the range of float.
  const double below = 1 / (l00 * l10 * l11), above = 1 / (l00 * l11 * l01);
  const double triple = z_ * (x - x0_) * (y1_ - y0_);
  const double im0 = triple * below, im1 = triple * above;
  const double re0 = 1 + (bottom * l11 + diagonal * l10 + right * l00) * below;
  const double re1 = 1 + (diagonal * l01 + left * l11 + top * l00) * above;
  return 2 * std::atan2(static_cast<float>(im0 * re1 + re0 * im1), static_cast<float>(re0 * re1 - im0 * im1));
}

Point2 SphericalRectangle::Sample(Point2 u) const {
  // z components of the normals of the planes through p and the lower and upper edge; along the other edges,
  // x's.
  const double b0 = -y0_ / std::sqrt(y0_ * y0_ + z_ * z_);
  const double b1 = y1_ / std::sqrt(y1_ * y1_ + z_ * z_);
  // Interior angles at the two corners of x0, as 2 pi - k of the paper, and their sum.
  const double left = x0_ / std::sqrt(x0_ * x0_ + z_ * z_);
  const double cos2 = left * b1, sin2 = std::sqrt((1 - cos2) * (1 + cos2));
  const double cos3 = left * b0, sin3 = std::sqrt((1 - cos3) * (1 + cos3));
  const double cos_sum = cos2 * cos3 - sin2 * sin3, sin_sum = sin2 * cos3 + cos2 * sin3;
  // The part of the area to cover, by half its angle, so that 1 - cos keeps its precision.
  const float half = u.x * area_ / 2;
  const double sin_half = std::sin(half), cos_half = std::cos(half);
  const double sin_part = 2 * sin_half * cos_half, cos_part = 1 - 2 * sin_half * sin_half;
  const double cos_au = cos_part * cos_sum + sin_part * sin_sum;
  const double sin_au = sin_part * cos_sum - cos_part * sin_sum;
  const double fu = (cos_au * b0 - b1) / sin_au;
  const double cu = std::copysign(1 / std::sqrt(fu * fu + b0 * b0), fu);
  const double one_minus_square = std::max((1 - cu) * (1 + cu), 1e-12);
  const double x = std::clamp(cu * z_ / std::sqrt(one_minus_square), x0_, x1_);
  const double d_squared = x * x + z_ * z_;
  const double h0 = y0_ / std::sqrt(d_squared + y0_ * y0_);
  const double h1 = y1_ / std::sqrt(d_squared + y1_ * y1_);
  const double h = h0 + u.y * (h1 - h0);
  const double y = std::clamp(h * std::sqrt(d_squared / std::max(1 - h * h, 1e-12)), y0_, y1_);
  return {ClampToUnit((x - x0_) / (x1_ - x0_)), ClampToUnit((y - y0_) / (y1_ - y0_))};
}

Point2 SphericalRectangle::Invert(Point2 place) const {
  const double x = x0_ + place.x * (x1_ - x0_);
  const double y = y0_ + place.y * (y1_ - y0_);
  const double d_squared = x * x + z_ * z_;
  const double h0 = y0_ / std::sqrt(d_squared + y0_ * y0_);
  const double h1 = y1_ / std::sqrt(d_squared + y1_ * y1_);
  const double h = y / std::sqrt(d_squared + y * y);
  return {ClampToUnit(AreaUpTo(x) / area_), ClampToUnit((h - h0) / (h1 - h0))};
}

}  // namespace tessera
