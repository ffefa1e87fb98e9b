// What directives change and later ones use: pushed by AttributeBegin and ObjectBegin, copied for an Import.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/scene_description.h"

namespace tessera {

// What an Attribute directive can set defaults for.
enum class AttributeTarget { kShape, kLight, kMaterial, kMedium, kTexture };
constexpr std::array<std::string_view, 5> kAttributeTargets{"shape", "light", "material", "medium",
                                                            "texture"};

class GraphicsState {
 public:
  TransformPair transform;  // the current transformation matrix, at both times
  bool start_is_active = true, end_is_active = true;
  std::string color_space = "srgb";
  bool reverse_orientation = false;
  MaterialReference material;
  std::shared_ptr<const Entity> area_light;  // null: shapes do not emit
  std::string inside_medium, outside_medium;

  // The active transforms become `next`, or themselves after `next`. False if a result is not finite: the
  // state is then unchanged.
  bool SetTransform(const Transform& next);
  bool ConcatTransform(const Transform& next);

  // Defaults of a target, in order of their Attribute directives.
  const std::vector<Parameter>& Attributes(AttributeTarget target) const;
  void AddAttributes(AttributeTarget target, std::vector<Parameter> parameters);

 private:
  bool Replace(const Transform& start, const Transform& end);

  // Shared between the states of the stack, replaced when added to: pushing a state copies no parameter.
  std::array<std::shared_ptr<const std::vector<Parameter>>, kAttributeTargets.size()> attributes_;
};

}  // namespace tessera
