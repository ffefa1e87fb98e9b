#include "renderer/math/moving_transform.h"

#include <algorithm>

#include "renderer/math/flat_transform.h"

namespace tessera {

MovingTransform::MovingTransform(std::span<const AnimatedTransform> factors) {
  for (const AnimatedTransform& factor : factors) {
    if (factor.IsAnimated() || !factor.First().IsIdentity()) factors_.push_back(MakeFactor(factor));
  }
}

MovingTransform::Factor MovingTransform::MakeFactor(const AnimatedTransform& transform) {
  const std::span<const TransformKey> keys = transform.keys();
  Factor factor{transform.First(), transform.First(), 0, 0, {}};
  if (keys.empty()) return factor;
  factor.last = keys.back().transform;
  factor.first_s = keys.front().time_s;
  factor.last_s = keys.back().time_s;
  for (size_t i = 0; i + 1 < keys.size(); ++i) {
    const TransformKey &a = keys[i], &b = keys[i + 1];
    if (a.time_s < b.time_s)
      factor.segments.push_back({a.time_s, b.time_s, TransformPath(a.transform, b.transform)});
  }
  return factor;
}

// As AnimatedTransform::At.
Transform MovingTransform::Factor::At(double time_s) const {
  if (time_s <= first_s) return first;
  const auto segment = std::ranges::lower_bound(segments, time_s, {}, &Segment::end_s);
  if (segment == segments.end()) return last;
  const std::optional<Transform> map = segment->path.At(segment->FractionAt(time_s));
  return map ? *map : Transform(ZeroMatrix(), ZeroMatrix());
}

Bounds3 MovingTransform::Factor::BoundsOf(const Bounds3& box, double from_s, double to_s) const {
  Bounds3 bounds;
  if (segments.empty() || from_s <= first_s) bounds.Add(first.ToBounds(box));
  if (to_s >= last_s) bounds.Add(last.ToBounds(box));
  for (const Segment& segment : segments) {
    if (segment.end_s < from_s || segment.start_s > to_s) continue;
    const float from = segment.FractionAt(std::max(from_s, segment.start_s));
    const float to = segment.FractionAt(std::min(to_s, segment.end_s));
    bounds.Add(segment.path.BoundsOf(box, from, to));
  }
  return bounds;
}

Transform MovingTransform::At(float time_s) const {
  if (factors_.empty()) return {};
  const Transform first = factors_[0].At(time_s);
  Matrix4 matrix = first.matrix();
  bool is_flat = IsFlat(first);
  for (size_t i = 1; i < factors_.size(); ++i) {
    const Transform map = factors_[i].At(time_s);
    matrix = matrix * map.matrix();
    is_flat |= IsFlat(map);
  }
  // Not the product of the inverses: see WithExactInverse.
  const std::optional<Matrix4> inverse = is_flat ? std::nullopt : AffineInverse(matrix);
  return {matrix, inverse ? *inverse : ZeroMatrix()};
}

Bounds3 MovingTransform::BoundsOf(const Bounds3& box, float from_s, float to_s) const {
  Bounds3 bounds = box;
  for (size_t i = factors_.size(); i > 0; --i) bounds = factors_[i - 1].BoundsOf(bounds, from_s, to_s);
  return bounds;
}

uint64_t MovingTransform::bytes() const {
  uint64_t bytes = factors_.size() * sizeof(Factor);
  for (const Factor& factor : factors_) bytes += factor.segments.size() * sizeof(Segment);
  return bytes;
}

}  // namespace tessera
