// Curves with a width, such as hair, fur and grass. The contract of the functions is in form.h.
//
// A curve is what a ray sees of it: at each point a line of the curve's width, across the curve and across
// the ray. A ray meets it where its distance to the axis has a minimum of at most half the width (Pharr,
// Jakob, Humphreys 2023, section 6.7). Ribbons are narrower the more they are seen from the side; cylinders
// are flat curves with the normals of a cylinder.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/math/transform.h"
#include "renderer/shape/curve_polynomial.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/shape_queries.h"

namespace tessera {

// Curves of one kind in one space. Each consists of segments, which share control points; each segment is
// split into 2^split_depth pieces of equal u, the primitives, whose boxes are tighter than that of the whole.
struct CurveSet {
  static constexpr std::string_view kPrimitives = "curve pieces";
  static constexpr int kSplitDepthMax = 10;
  // The limit of the accelerator "bvh".
  static constexpr uint64_t kPiecesMax = uint64_t{1} << 28;

  enum class Type : uint8_t { kFlat, kRibbon, kCylinder };
  struct Segment {
    uint32_t first_point = 0;      // of degree + 1 in P
    float width0 = 0, width1 = 0;  // at u = 0 and u = 1; linear between
  };
  // A part of a segment.
  struct Piece {
    uint32_t segment = 0;
    double u0 = 0, u1 = 1;
  };

  std::vector<Point3> P;
  std::vector<Segment> segments;
  std::vector<Normal3> N;  // of ribbons: two unit normals per segment; empty for other types
  // From the space of P, N and widths. Null: they are in the space of the form.
  std::shared_ptr<const Transform> render_from_object;
  Type type = Type::kFlat;
  CurveBasis basis = CurveBasis::kBezier;
  uint8_t degree = 3;  // or 2
  uint8_t split_depth = 3;
  bool flip_normals = false;

  uint32_t PrimitiveCount() const { return static_cast<uint32_t>(segments.size() << split_depth); }
  uint64_t Bytes() const;
  Bounds3 PrimitiveBounds(uint32_t primitive) const;
  // Contains all primitives, and takes no longer to compute for more of them: that of whole segments.
  Bounds3 HullBounds() const;

  bool Intersect(uint32_t primitive, const DoubleRay& ray, double t_max, Crossing* crossing) const;
  // A piece bent so strongly that a line meets it three times lets light that its alpha let pass twice pass
  // for good.
  int CrossingsMax(uint32_t) const { return 2; }
  // Only our own intersection finds curves, and that is exact.
  bool Refine(const HitRay&, Hit*) const { return true; }

  // The point is on the ray where it passes the axis, and the error is the width: rays leave from outside.
  void FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const;
  void FillHitPoint(const Hit& hit, const HitRay& ray, HitPoint* point) const;

  // Curves do not emit: where their surface is depends on who looks.
  std::optional<ShapeSample> Sample(uint32_t, const ReferencePoint&, Point2, bool) const {
    return std::nullopt;
  }
  float Pdf(uint32_t, const ReferencePoint&, Vec3, const SurfaceInteraction&) const { return 0; }
  // Of the piece laid flat, in the space of P; its length is that of its control polygon.
  float Area(uint32_t primitive) const;
  NormalCone Normals(uint32_t) const { return {}; }

  Piece PieceOf(uint32_t primitive) const {
    const uint32_t pieces = 1u << split_depth;
    const double length = 1.0 / pieces;
    const uint32_t index = primitive & (pieces - 1);
    return {primitive >> split_depth, index * length, (index + 1) * length};
  }
  double WidthAt(uint32_t segment, double u) const {
    const Segment& s = segments[segment];
    return (1 - u) * s.width0 + u * s.width1;
  }
  Bounds3 BoundsOf(const Piece& piece) const;
  // As seen from `origin`: control points relative to it keep the precision of near curves.
  CurvePolynomial Polynomial(uint32_t segment, Double3 origin) const;
  // The unit normal of a ribbon, along the great circle between those of the ends of the segment.
  Normal3 RibbonNormal(uint32_t segment, double u) const;

  // Whether the curves of `other` may be stored with these. Taking them changes no primitive of this set.
  bool CanTake(const CurveSet& other) const;
  void Take(const CurveSet& other);
};

}  // namespace tessera
