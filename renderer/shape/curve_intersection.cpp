#include "renderer/shape/curve_intersection.h"

#include <algorithm>

namespace tessera {
namespace {

// Axes across the ray, unit, and one along it whose product with an offset is in units of t. x, y and the
// ray's direction are right-handed.
struct RayAxes {
  Double3 x, y, t, direction;

  explicit RayAxes(Double3 d) {
    const double length_squared = Dot(d, d);
    t = d * (1 / length_squared);
    const Double3 z = direction = d * (1 / std::sqrt(length_squared));
    // Duff et al. 2017, as CoordinateSystem.
    const double sign = std::copysign(1.0, z.z);
    const double a = -1 / (sign + z.z);
    const double b = z.x * z.y * a;
    x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x};
    y = {b, sign + z.y * z.y * a, -z.y};
  }
};

// A point of the curve as the ray sees it, which lies at x = y = 0, and the derivatives by u.
struct SeenPoint {
  double x, y, t;
  double dx, dy, dt;

  // Half the derivative of the squared distance to the ray.
  double Slope() const { return x * dx + y * dy; }
};

// The segment as the ray sees it: coefficients of powers of u.
struct SeenSegment {
  double x[4], y[4], t[4];

  SeenSegment(const CurvePolynomial& curve, const RayAxes& axes) {
    for (int i = 0; i < 4; ++i) {
      x[i] = Dot(axes.x, curve.c[i]);
      y[i] = Dot(axes.y, curve.c[i]);
      t[i] = Dot(axes.t, curve.c[i]);
    }
  }
  SeenPoint At(double u) const {
    return {Value(x, u), Value(y, u), Value(t, u), Derivative(x, u), Derivative(y, u), Derivative(t, u)};
  }
  // The derivative of SeenPoint::Slope.
  double Curvature(const SeenPoint& p, double u) const {
    return p.dx * p.dx + p.dy * p.dy + p.x * (2 * x[2] + 6 * x[3] * u) + p.y * (2 * y[2] + 6 * y[3] * u);
  }

 private:
  static double Value(const double c[4], double u) { return c[0] + (c[1] + (c[2] + c[3] * u) * u) * u; }
  static double Derivative(const double c[4], double u) { return c[1] + (2 * c[2] + 3 * c[3] * u) * u; }
};

// The control polygon of a part of the segment.
struct SeenHull {
  double x[4], y[4], t[4];
  double chord_x, chord_y, chord_squared;

  SeenHull(const SeenPoint& a, const SeenPoint& b, double length) {
    const double third = length / 3;
    const auto fill = [third](double out[4], double p0, double d0, double p3, double d3) {
      out[0] = p0;
      out[1] = p0 + d0 * third;
      out[2] = p3 - d3 * third;
      out[3] = p3;
    };
    fill(x, a.x, a.dx, b.x, b.dx);
    fill(y, a.y, a.dy, b.y, b.dy);
    fill(t, a.t, a.dt, b.t, b.dt);
    chord_x = x[3] - x[0];
    chord_y = y[3] - y[0];
    chord_squared = chord_x * chord_x + chord_y * chord_y;
  }

  // Whether the ray can pass a point of the part at a distance of at most `reach`, with t in (0, t_max].
  bool IsNear(double reach, double t_max) const {
    double side[4], along[4];
    for (int i = 0; i < 4; ++i) {
      side[i] = chord_x * y[i] - chord_y * x[i];
      along[i] = chord_x * x[i] + chord_y * y[i];
    }
    const double limit = reach * std::sqrt(chord_squared);
    return Least(side) <= limit && Most(side) >= -limit && Least(along) <= limit && Most(along) >= -limit &&
           Least(t) <= t_max && Most(t) > 0;
  }

  // Whether the distance to the ray surely has at most one minimum: its slope grows along the whole part. The
  // slope's derivative is |c'|^2 + c . c'' with |c'| >= 3 m / |chord|, |c| <= r and |c''| <= 6 s.
  bool HasOneMinimum() const {
    double m = chord_squared, r_squared = 0;
    for (int i = 0; i < 4; ++i) {
      r_squared = std::max(r_squared, x[i] * x[i] + y[i] * y[i]);
      if (i > 0) m = std::min(m, chord_x * (x[i] - x[i - 1]) + chord_y * (y[i] - y[i - 1]));
    }
    return m > 0 && 9 * m * m * m * m > 4 * r_squared * BendSquared() * chord_squared * chord_squared;
  }
  // The squared second difference of the control points.
  double BendSquared() const {
    double bend_squared = 0;
    for (int i = 0; i < 2; ++i) {
      const double bend_x = x[i] - 2 * x[i + 1] + x[i + 2], bend_y = y[i] - 2 * y[i + 1] + y[i + 2];
      bend_squared = std::max(bend_squared, bend_x * bend_x + bend_y * bend_y);
    }
    return bend_squared;
  }

 private:
  static double Least(const double v[4]) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }
  static double Most(const double v[4]) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
};

// Searches a piece by halving it until its parts have one minimum of the distance each.
class PieceSearch {
 public:
  PieceSearch(const CurveSet& curves, uint32_t segment, const DoubleRay& ray, double t_max)
      : curves_(curves),
        segment_(segment),
        curve_(curves.Polynomial(segment, ray.o)),
        axes_(ray.d),
        seen_(curve_, axes_),
        t_max_(t_max) {}

  bool Search(double u0, double u1, Crossing* crossing) {
    Visit(u0, seen_.At(u0), u1, seen_.At(u1), kDepthMax);
    if (found_) *crossing = best_;
    return found_;
  }

 private:
  // As pbrt's.
  static constexpr int kDepthMax = 10;
  // Parts that bend by no more than this share of half their width are taken to have one minimum: two of them
  // would be much closer to each other than the width.
  static constexpr double kFlatBend = 1.0 / 16;

  void Visit(double u0, const SeenPoint& start, double u1, const SeenPoint& end, int depth) {
    const double reach = std::max(curves_.WidthAt(segment_, u0), curves_.WidthAt(segment_, u1)) / 2;
    const SeenHull hull(start, end, u1 - u0);
    if (!hull.IsNear(reach, t_max_)) return;
    const double flat_bend = kFlatBend * reach;
    if (depth == 0 || hull.HasOneMinimum() || hull.BendSquared() <= flat_bend * flat_bend) {
      VisitPart(u0, start, u1, end);
      return;
    }
    const double middle = (u0 + u1) / 2;
    const SeenPoint at_middle = seen_.At(middle);
    Visit(u0, start, middle, at_middle, depth - 1);
    Visit(middle, at_middle, u1, end, depth - 1);
  }

  // The minimum is where the slope turns positive. Parts that meet see the same slope there, so just one of
  // them has the minimum; segments that meet see the same within rounding.
  void VisitPart(double u0, const SeenPoint& start, double u1, const SeenPoint& end) {
    const bool starts = u0 == 0 ? start.Slope() <= Rounding(start) : start.Slope() <= 0;
    const bool ends = u1 == 1 ? end.Slope() >= -Rounding(end) : end.Slope() > 0;
    if (!starts || !ends) return;
    const double u = Minimum(u0, start.Slope(), u1, end.Slope());
    const SeenPoint p = seen_.At(u);
    const double width = SeenCurveWidth(curves_, segment_, u, axes_.direction);
    const double distance_squared = p.x * p.x + p.y * p.y;
    if (!(width > 0 && distance_squared <= width * width / 4 && p.t > 0 && p.t <= t_max_)) return;
    const double side = p.x * p.dy - p.y * p.dx;  // positive: the ray passes to the left
    const double offset = std::min(std::sqrt(distance_squared) / width, 0.5);
    best_ = {p.t, static_cast<float>(u), static_cast<float>(side > 0 ? 0.5 + offset : 0.5 - offset)};
    t_max_ = p.t;
    found_ = true;
  }

  // A bound of the rounding error of the slope at an end of the segment.
  double Rounding(const SeenPoint& p) const {
    const Double3& start = curve_.c[0];
    const double distance = std::abs(start.x) + std::abs(start.y) + std::abs(start.z);
    return 1e-14 * distance * (std::abs(p.dx) + std::abs(p.dy));
  }

  // The root of the slope between u0 and u1, by Newton's method within bounds that halve where it fails.
  double Minimum(double u0, double slope0, double u1, double slope1) const {
    if (slope0 >= 0) return u0;
    if (slope1 <= 0) return u1;
    constexpr int kStepsMax = 40;
    const double close = 1e-12 * (u1 - u0);
    double u = u0 - slope0 * ((u1 - u0) / (slope1 - slope0));
    for (int i = 0; i < kStepsMax; ++i) {
      const SeenPoint p = seen_.At(u);
      const double slope = p.Slope();
      (slope < 0 ? u0 : u1) = u;
      double next = u - slope / seen_.Curvature(p, u);
      if (!(next >= u0 && next <= u1)) next = (u0 + u1) / 2;
      const double step = std::abs(next - u);
      u = next;
      if (!(step > close)) break;
    }
    return u;
  }

  const CurveSet& curves_;
  uint32_t segment_;
  CurvePolynomial curve_;
  RayAxes axes_;
  SeenSegment seen_;
  double t_max_;  // or that of the best
  Crossing best_;
  bool found_ = false;
};

}  // namespace

double SeenCurveWidth(const CurveSet& curves, uint32_t segment, double u, Double3 d) {
  const double width = curves.WidthAt(segment, u);
  if (curves.type != CurveSet::Type::kRibbon) return width;
  return width * std::min(1.0, std::abs(Dot(Double3(curves.RibbonNormal(segment, u)), d)));
}

bool IntersectCurvePiece(const CurveSet& curves, const CurveSet::Piece& piece, const DoubleRay& ray,
                         double t_max, Crossing* crossing) {
  return PieceSearch(curves, piece.segment, ray, t_max).Search(piece.u0, piece.u1, crossing);
}

}  // namespace tessera
