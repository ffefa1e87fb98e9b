#include "renderer/pbrt/graphics_state.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "renderer/math/flat_transform.h"

namespace tessera {
namespace {

bool IsFinite(const Matrix4& matrix) {
  for (const auto& row : matrix.m) {
    for (const float v : row) {
      if (!std::isfinite(v)) return false;
    }
  }
  return true;
}

// Makes a map flat whose inverse is beyond the range of float. Returns false if the map itself is.
bool Settle(Transform& transform) {
  if (!IsFinite(transform.matrix())) return false;
  if (!IsFinite(transform.inverse_matrix())) transform = Transform(transform.matrix(), ZeroMatrix());
  return true;
}

}  // namespace

AnimatedTransform TransformTimes::Animate(const TransformPair& pair) const {
  if (pair.start == pair.end) return AnimatedTransform(pair.start);
  return AnimatedTransform({{start, pair.start}, {std::max(start, end), pair.end}});
}

bool GraphicsState::Replace(Transform start, Transform end) {
  if (start_is_active && !Settle(start)) return false;
  if (end_is_active && !Settle(end)) return false;
  if (start_is_active) transform.start = start;
  if (end_is_active) transform.end = end;
  return true;
}

bool GraphicsState::SetTransform(const Transform& next) {
  return Replace(next, next);
}

bool GraphicsState::ConcatTransform(const Transform& next) {
  return Replace(transform.start * next, transform.end * next);
}

const std::vector<Parameter>& GraphicsState::Attributes(AttributeTarget target) const {
  static const std::vector<Parameter> kNone;
  const auto& list = attributes_[static_cast<size_t>(target)];
  return list ? *list : kNone;
}

void GraphicsState::AddAttributes(AttributeTarget target, std::vector<Parameter> parameters) {
  auto list = std::make_shared<std::vector<Parameter>>(Attributes(target));
  list->insert(list->end(), std::make_move_iterator(parameters.begin()),
               std::make_move_iterator(parameters.end()));
  attributes_[static_cast<size_t>(target)] = std::move(list);
}

}  // namespace tessera
