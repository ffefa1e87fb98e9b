// What directives change and later ones use. A state is copied at every push, so it is small: what it refers
// to is shared and never changed.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/scene_description.h"

namespace tessera {

// What an Attribute directive can set defaults for.
enum class AttributeTarget { kShape, kLight, kMaterial, kMedium, kTexture };
constexpr std::array<std::string_view, 5> kAttributeTargets{"shape", "light", "material", "medium",
                                                            "texture"};

// A transform at the two times of TransformTimes.
struct TransformPair {
  Transform start, end;
  TransformPair Inverse() const { return {start.Inverse(), end.Inverse()}; }
};

// The times of TransformTimes, in seconds.
struct TransformTimes {
  float start = 0, end = 1;
  // Moves from pair.start to pair.end between the times; in one step, after `start`, if `end` is not later.
  AnimatedTransform Animate(const TransformPair& pair) const;
};

class GraphicsState {
 public:
  TransformPair transform;  // the current transformation matrix
  bool start_is_active = true, end_is_active = true;
  std::string color_space = "srgb";
  bool reverse_orientation = false;
  MaterialReference material;
  std::shared_ptr<const Entity> area_light;  // null: shapes do not emit
  std::string inside_medium, outside_medium;

  // Replaces the active transforms by `next`, or appends `next` to them; the results may be flat
  // (flat_transform.h). Returns false and leaves the state unchanged if a result is not finite.
  bool SetTransform(const Transform& next);
  bool ConcatTransform(const Transform& next);

  // The defaults of a target, in order of their Attribute directives.
  const std::vector<Parameter>& Attributes(AttributeTarget target) const;
  void AddAttributes(AttributeTarget target, std::vector<Parameter> parameters);

 private:
  bool Replace(Transform start, Transform end);

  // Shared between the states of the stack, replaced when added to: pushing a state copies no parameter.
  std::array<std::shared_ptr<const std::vector<Parameter>>, kAttributeTargets.size()> attributes_;
};

}  // namespace tessera
