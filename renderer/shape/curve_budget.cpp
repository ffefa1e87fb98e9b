#include "renderer/shape/curve_budget.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

constexpr int kDefaultDepth = 3;  // pbrt's

template <typename Visit>
void VisitCurves(Geometry& geometry, const Visit& visit) {
  const auto visit_shapes = [&](std::vector<Shape>& shapes) {
    for (Shape& shape : shapes) {
      if (auto* const curves = std::get_if<CurveSet>(&shape.form)) visit(*curves);
    }
  };
  visit_shapes(geometry.shapes);
  for (ShapeGroup& group : geometry.groups) visit_shapes(group.shapes);
}

}  // namespace

std::optional<int> LimitCurvePieces(Geometry& geometry) {
  std::array<uint64_t, CurveSet::kSplitDepthMax + 1> segments{};  // by depth
  uint64_t all = 0;
  VisitCurves(geometry, [&](const CurveSet& curves) {
    segments[curves.split_depth] += curves.segments.size();
    all += curves.segments.size();
  });
  const uint64_t pieces_max = std::max(kCurvePiecesFloor, all << kDefaultDepth);
  const auto pieces_at = [&](int depth_max) {
    uint64_t pieces = 0;
    for (int depth = 0; depth <= CurveSet::kSplitDepthMax; ++depth)
      pieces += segments[static_cast<size_t>(depth)] << std::min(depth, depth_max);
    return pieces;
  };
  int depth_max = CurveSet::kSplitDepthMax;
  while (pieces_at(depth_max) > pieces_max) --depth_max;
  if (depth_max == CurveSet::kSplitDepthMax) return std::nullopt;
  VisitCurves(geometry, [&](CurveSet& curves) {
    curves.split_depth = static_cast<uint8_t>(std::min<int>(curves.split_depth, depth_max));
  });
  return depth_max;
}

}  // namespace tessera
