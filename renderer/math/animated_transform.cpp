#include "renderer/math/animated_transform.h"

#include <algorithm>
#include <utility>

#include "renderer/math/motion.h"
#include "renderer/util/check.h"

namespace tessera {

AnimatedTransform::AnimatedTransform(std::vector<TransformKey> keys) {
  TESSERA_CHECK(!keys.empty());
  TESSERA_CHECK(std::ranges::is_sorted(keys, {}, &TransformKey::time_s));
  first_ = keys.front().transform;
  const auto differs = [this](const TransformKey& key) { return !(key.transform == first_); };
  if (std::ranges::any_of(keys, differs))
    keys_ = std::make_shared<const std::vector<TransformKey>>(std::move(keys));
}

std::optional<Transform> AnimatedTransform::At(double time_s) const {
  if (!keys_) return first_;
  const auto after = std::ranges::lower_bound(*keys_, time_s, {}, &TransformKey::time_s);
  if (after == keys_->begin()) return first_;
  if (after == keys_->end()) return keys_->back().transform;
  const TransformKey &a = *std::prev(after), &b = *after;  // a.time_s < time_s <= b.time_s
  const auto fraction = static_cast<float>((time_s - a.time_s) / (b.time_s - a.time_s));
  return Interpolate(a.transform, b.transform, fraction);
}

const Transform& AnimatedTransform::Fixed() const {
  TESSERA_CHECK(!IsAnimated());
  return first_;
}

AnimatedTransform AnimatedTransform::Delayed(double delay_s) const {
  if (!keys_) return *this;
  std::vector<TransformKey> keys = *keys_;
  for (TransformKey& key : keys) key.time_s += delay_s;
  return AnimatedTransform(std::move(keys));
}

AnimatedTransform AnimatedTransform::Inverse() const {
  if (!keys_) return AnimatedTransform(first_.Inverse());
  std::vector<TransformKey> keys = *keys_;
  for (TransformKey& key : keys) key.transform = key.transform.Inverse();
  return AnimatedTransform(std::move(keys));
}

}  // namespace tessera
