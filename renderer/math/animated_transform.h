// A transform that changes over time.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "renderer/math/transform.h"

namespace tessera {

struct TransformKey {
  double time_s = 0;
  Transform transform;
  bool operator==(const TransformKey&) const = default;
};

// A value; copies share their keys.
class AnimatedTransform {
 public:
  // The same at all times.
  AnimatedTransform() = default;
  explicit AnimatedTransform(const Transform& transform) : first_(transform) {}
  // The keys must not be empty and their times must not fall. At two keys of equal time the transform jumps.
  explicit AnimatedTransform(std::vector<TransformKey> keys);

  // Whether any two keys differ.
  bool IsAnimated() const { return keys_ != nullptr; }

  // The transform at `time_s`: interpolated between the keys around it (renderer/math/motion.h), the first
  // one before all keys and the last one after them. Returns nullopt if the map is singular there.
  std::optional<Transform> At(double time_s) const;

  // The transform of what does not move: it must not be animated.
  const Transform& Fixed() const;
  // The transform before and at the first key.
  const Transform& First() const { return first_; }

  // Empty if it does not move.
  std::span<const TransformKey> keys() const {
    return keys_ ? std::span<const TransformKey>(*keys_) : std::span<const TransformKey>();
  }
  bool operator==(const AnimatedTransform& other) const {
    return first_ == other.first_ && std::ranges::equal(keys(), other.keys());
  }

  // The same motion, by `delay_s` later.
  AnimatedTransform Delayed(double delay_s) const;

  // Key by key.
  AnimatedTransform Inverse() const;

  // Of the keys, beyond the size of the object.
  uint64_t bytes() const { return keys_ ? keys_->size() * sizeof(TransformKey) : 0; }

 private:
  Transform first_;
  std::shared_ptr<const std::vector<TransformKey>> keys_;  // null if all are equal
};

}  // namespace tessera
