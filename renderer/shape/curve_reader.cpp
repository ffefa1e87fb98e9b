#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "renderer/shape/shape_directive.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 2> kBases = {"bezier", "bspline"};

CurveSet::Type ReadType(const ShapeDirective& directive) {
  const std::string type = directive.reader.String("type", "flat");
  if (type == "flat") return CurveSet::Type::kFlat;
  if (type == "ribbon") return CurveSet::Type::kRibbon;
  if (type != "cylinder") {
    directive.Warn("type", fmt::format("unknown type \"{}\" of curve, expected one of flat, ribbon, "
                                       "cylinder; it is rendered as \"cylinder\"",
                                       type));
  }
  return CurveSet::Type::kCylinder;
}

// The number of segments of `points` control points; 0, with an error, if there is none.
size_t CountSegments(ParameterReader& reader, CurveBasis basis, size_t degree, size_t points) {
  const bool is_bezier = basis == CurveBasis::kBezier;
  if (points > degree && (!is_bezier || (points - 1) % degree == 0))
    return is_bezier ? (points - 1) / degree : points - degree;
  reader.FailAt("P", is_bezier
                         ? fmt::format("a Bezier curve of degree {} needs {} + n * {} control points, got {}",
                                       degree, degree + 1, degree, points)
                         : fmt::format("a B-spline of degree {} needs at least {} control points, got {}",
                                       degree, degree + 1, points));
  return 0;
}

// At the ends of the segments, unit length; two for each segment.
std::vector<Normal3> ReadNormals(const ShapeDirective& directive, CurveSet::Type type, size_t segments) {
  ParameterReader& reader = directive.reader;
  const std::vector<Normal3> given = reader.Normals("N");
  if (type != CurveSet::Type::kRibbon) {
    if (!given.empty()) directive.Warn("N", "\"N\" is ignored: only curves of type \"ribbon\" have normals");
    return {};
  }
  std::vector<Normal3> normals;
  if (given.size() != segments + 1) {
    reader.FailAt("N", fmt::format("a ribbon of {} segments needs {} normals \"N\", got {}", segments,
                                   segments + 1, given.size()));
    return normals;
  }
  for (size_t i = 0; i < segments; ++i) {
    for (const Normal3 n : {given[i], given[i + 1]}) {
      const double length = std::sqrt(Dot(Double3(n), Double3(n)));
      if (!(length > 0)) reader.FailAt("N", "a normal of a ribbon is zero");
      normals.push_back((Double3(n) * (1 / length)).ToFloat());
    }
  }
  return normals;
}

float ReadWidth(ParameterReader& reader, std::string_view name, float default_width) {
  const float width = reader.Float(name, default_width);
  if (width < 0) reader.FailAt(name, fmt::format("{} must not be negative", name));
  return width;
}

// The factor by which a map scales all lengths, if it keeps angles and handedness; else nullopt.
std::optional<float> UniformScale(const Transform& transform) {
  constexpr double kTolerance = 1e-6;  // of lengths; of the widths of curves nobody can see it
  const auto& m = transform.matrix().m;
  const Double3 axes[3] = {
      {m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}};
  const double square = Dot(axes[0], axes[0]);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(Dot(axes[i], axes[i]) - square) > kTolerance * square) return std::nullopt;
    if (std::abs(Dot(axes[i], axes[(i + 1) % 3])) > kTolerance * square) return std::nullopt;
  }
  const bool is_affine = m[3][0] == 0 && m[3][1] == 0 && m[3][2] == 0 && m[3][3] == 1;
  if (!is_affine || !(square > 0) || transform.SwapsHandedness()) return std::nullopt;
  return static_cast<float>(std::sqrt(square));
}

// Takes the curves to rendering space, where they are intersected faster, if that changes no angle: widths
// are measured in the space of the directive.
void Place(const Placement& placement, CurveSet* curves) {
  const Transform& transform = placement.render_from_object;
  curves->flip_normals = placement.FlipsNormals();
  if (transform.IsIdentity()) return;
  const std::optional<float> scale = UniformScale(transform);
  if (!scale) {
    curves->render_from_object = std::make_shared<const Transform>(transform);
    return;
  }
  for (Point3& p : curves->P) p = transform.ToPoint(p);
  for (Normal3& n : curves->N) n = Normalize(transform.ToNormal(n));
  for (CurveSet::Segment& segment : curves->segments) {
    segment.width0 *= *scale;
    segment.width1 *= *scale;
  }
}

void AddSegments(size_t count, float width0, float width1, CurveSet* curves) {
  const size_t step = curves->basis == CurveBasis::kBezier ? curves->degree : 1;
  const auto width_at = [&](size_t i) {
    return Lerp(static_cast<float>(i) / static_cast<float>(count), width0, width1);
  };
  curves->segments.reserve(count);
  for (size_t i = 0; i < count; ++i)
    curves->segments.push_back({static_cast<uint32_t>(i * step), width_at(i), width_at(i + 1)});
}

}  // namespace

std::vector<Form> ReadCurve(const ShapeDirective& directive) {
  ParameterReader& reader = directive.reader;
  const float width = ReadWidth(reader, "width", 1);
  const float width0 = ReadWidth(reader, "width0", width);
  const float width1 = ReadWidth(reader, "width1", width);
  CurveSet curves;
  const int degree = reader.Integer("degree", 3);
  if (degree != 2 && degree != 3) reader.FailAt("degree", "degree must be 2 or 3");
  curves.basis =
      reader.Choice("basis", "bezier", kBases) == "bspline" ? CurveBasis::kBSpline : CurveBasis::kBezier;
  curves.type = ReadType(directive);
  curves.P = reader.Point3s("P");
  int split_depth = std::clamp(reader.Integer("splitdepth", 3), 0, CurveSet::kSplitDepthMax);
  if (reader.failed()) return {};
  curves.degree = static_cast<uint8_t>(degree);
  const size_t count = CountSegments(reader, curves.basis, curves.degree, curves.P.size());
  if (count > CurveSet::kPiecesMax) reader.FailAt("P", "the curve has too many segments");
  curves.N = ReadNormals(directive, curves.type, count);
  if (reader.failed()) return {};
  if (!(width0 > 0 || width1 > 0)) {
    directive.diagnostics.Warn(reader.entity().location, "the curve is not shown: its width is 0");
    return {};
  }
  // The depth changes the speed, not the picture.
  while (count << split_depth > CurveSet::kPiecesMax) --split_depth;
  curves.split_depth = static_cast<uint8_t>(split_depth);
  AddSegments(count, width0, width1, &curves);
  Place(directive.placement, &curves);
  std::vector<Form> forms;
  forms.emplace_back(std::move(curves));
  return forms;
}

}  // namespace tessera
