#include "renderer/shape/curve_set.h"

#include <algorithm>

#include "renderer/shape/curve_intersection.h"
#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

Vec3 UnitOr(Double3 v, Vec3 fallback) {
  const double length = std::sqrt(Dot(v, v));
  return length > 0 && std::isfinite(length) ? (v * (1 / length)).ToFloat() : fallback;
}

// The derivative by u. Where control points coincide it may be zero: then the direction in which the curve
// goes on, or that of the whole segment.
Double3 TangentAt(const CurvePolynomial& curve, double u) {
  const Double3 tangent = curve.Derivative(u);
  if (Dot(tangent, tangent) > 0) return tangent;
  const Double3 bend = (curve.c[2] * 2 + curve.c[3] * (6 * u)) * (u < 0.5 ? 1 : -1);
  return Dot(bend, bend) > 0 ? bend : curve.At(1) - curve.At(0);
}

// The local geometry in the space of the control points.
struct CurvePlace {
  Double3 p;
  float width = 0;  // as the ray sees it
  Vec3 dpdu, dpdv;
  Normal3 n;  // unit, not flipped
};

CurvePlace PlaceOf(const CurveSet& curves, const Hit& hit, const DoubleRay& ray) {
  const uint32_t segment = curves.PieceOf(hit.primitive).segment;
  CurvePlace place;
  place.p = ray.At(hit.t);
  const Vec3 away = UnitOr(ray.d, {0, 0, 1});
  const Double3 tangent = TangentAt(curves.Polynomial(segment, ray.o), hit.u);
  Vec3 any_across, any_along;
  CoordinateSystem(away, &any_along, &any_across);
  const Vec3 along = UnitOr(tangent, any_along);
  place.dpdu = IsFinite(tangent.ToFloat()) && !IsZero(tangent.ToFloat()) ? tangent.ToFloat() : along;
  // To the left of the curve as the ray sees it.
  const Vec3 left = UnitOr(Cross(Double3(away), tangent), any_across);
  Vec3 across = left;
  place.width = static_cast<float>(SeenCurveWidth(curves, segment, hit.u, Double3(away)));
  if (curves.type == CurveSet::Type::kCylinder) {
    const float theta = (hit.v - 0.5f) * kPi;
    across = left * std::cos(theta) - Cross(along, left) * std::sin(theta);
  } else if (curves.type == CurveSet::Type::kRibbon) {
    across = UnitOr(Cross(Double3(curves.RibbonNormal(segment, hit.u)), tangent), left);
  }
  place.dpdv = across * place.width;
  place.n = UnitOr(Cross(Double3(along), Double3(across)), away);
  return place;
}

DoubleRay InCurveSpace(const CurveSet& curves, const DoubleRay& ray) {
  return curves.render_from_object ? ray.TransformedBy(curves.render_from_object->inverse_matrix()) : ray;
}

// In the space of the form.
Normal3 PlacedNormal(const CurveSet& curves, Normal3 n) {
  if (curves.render_from_object) n = Normalize(curves.render_from_object->ToNormal(n));
  return curves.flip_normals ? -n : n;
}

}  // namespace

uint64_t CurveSet::Bytes() const {
  return P.size() * sizeof(Point3) + segments.size() * sizeof(Segment) + N.size() * sizeof(Normal3) +
         (render_from_object ? sizeof(Transform) : 0);
}

CurvePolynomial CurveSet::Polynomial(uint32_t segment, Double3 origin) const {
  Double3 p[4];
  const Point3* points = &P[segments[segment].first_point];
  for (int i = 0; i <= degree; ++i) p[i] = Double3(points[i]) - origin;
  return MakeCurvePolynomial(basis, degree, p);
}

Normal3 CurveSet::RibbonNormal(uint32_t segment, double u) const {
  const Normal3 n0 = N[2 * size_t{segment}], n1 = N[2 * size_t{segment} + 1];
  const float angle = AngleBetween(n0, n1), at = static_cast<float>(u);
  const float sine = std::sin(angle);
  constexpr float kSineMin = 1e-4f;  // both are the same, or opposite: no great circle is known
  if (!(sine > kSineMin)) return Lerp(at, n0, n1);
  return n0 * (std::sin((1 - at) * angle) / sine) + n1 * (std::sin(at * angle) / sine);
}

Bounds3 CurveSet::PrimitiveBounds(uint32_t primitive) const {
  return BoundsOf(PieceOf(primitive));
}

Bounds3 CurveSet::HullBounds() const {
  Bounds3 bounds;
  for (uint32_t i = 0; i < segments.size(); ++i) bounds.Add(BoundsOf({i, 0, 1}));
  return bounds;
}

Bounds3 CurveSet::BoundsOf(const Piece& piece) const {
  const CurveHull hull = HullOf(Polynomial(piece.segment, {}), piece.u0, piece.u1);
  const double width = std::max(WidthAt(piece.segment, piece.u0), WidthAt(piece.segment, piece.u1));
  const auto half = static_cast<float>(width / 2);
  Bounds3 bounds;
  for (const Double3& p : hull.p) bounds.Add(p.ToFloat());
  bounds.min = bounds.min - Vec3{half, half, half};
  bounds.max = bounds.max + Vec3{half, half, half};
  // Room for rounding, also that of the corners.
  const auto pad = [](Bounds3 b) {
    const Vec3 largest = Max(Abs(b.min), Abs(b.max));
    return Bounds3{b.min - largest * Gamma(8), b.max + largest * Gamma(8)};
  };
  bounds = pad(bounds);
  return render_from_object ? pad(render_from_object->ToBounds(bounds)) : bounds;
}

bool CurveSet::Intersect(uint32_t primitive, const DoubleRay& ray, double t_max, Crossing* crossing) const {
  return IntersectCurvePiece(*this, PieceOf(primitive), InCurveSpace(*this, ray), t_max, crossing);
}

void CurveSet::FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const {
  CurvePlace place = PlaceOf(*this, hit, InCurveSpace(*this, ray.InShapeSpace()));
  const Vec3 error{place.width, place.width, place.width};
  interaction->p = place.p.ToFloat();
  interaction->p_error = error;
  interaction->faces_rays = true;
  if (render_from_object) {
    const PointWithError point = TransformPointWithError(*render_from_object, place.p, error);
    interaction->p = point.p;
    interaction->p_error = point.error;
    place.dpdu = render_from_object->ToVector(place.dpdu);
    place.dpdv = render_from_object->ToVector(place.dpdv);
  }
  interaction->uv = {hit.u, hit.v};
  interaction->dpdu = place.dpdu;
  interaction->dpdv = place.dpdv;
  interaction->n = PlacedNormal(*this, place.n);
  interaction->shading = {interaction->n, place.dpdu, place.dpdv, {}, {}};
}

void CurveSet::FillHitPoint(const Hit& hit, const HitRay& ray, HitPoint* point) const {
  point->uv = {hit.u, hit.v};
  point->n = PlacedNormal(*this, PlaceOf(*this, hit, InCurveSpace(*this, ray.InShapeSpace())).n);
}

float CurveSet::Area(uint32_t primitive) const {
  const Piece piece = PieceOf(primitive);
  const CurveHull hull = HullOf(Polynomial(piece.segment, {}), piece.u0, piece.u1);
  double length = 0;
  for (int i = 0; i < 3; ++i) {
    const Double3 edge = hull.p[i + 1] - hull.p[i];
    length += std::sqrt(Dot(edge, edge));
  }
  return static_cast<float>(length * WidthAt(piece.segment, (piece.u0 + piece.u1) / 2));
}

bool CurveSet::CanTake(const CurveSet& other) const {
  const bool same_space = render_from_object && other.render_from_object
                              ? *render_from_object == *other.render_from_object
                              : !render_from_object && !other.render_from_object;
  return same_space && type == other.type && basis == other.basis && degree == other.degree &&
         split_depth == other.split_depth && flip_normals == other.flip_normals &&
         (segments.size() + other.segments.size()) << split_depth <= kPiecesMax &&
         P.size() + other.P.size() <= kPiecesMax;
}

void CurveSet::Take(const CurveSet& other) {
  const auto offset = static_cast<uint32_t>(P.size());
  P.insert(P.end(), other.P.begin(), other.P.end());
  N.insert(N.end(), other.N.begin(), other.N.end());
  for (Segment segment : other.segments) {
    segment.first_point += offset;
    segments.push_back(segment);
  }
}

}  // namespace tessera
