// The table of all directives.
#include "renderer/pbrt/scene_parser.h"

namespace tessera {

struct DirectiveTable {
  using P = SceneParser;
  static constexpr Block kAny = Block::kAny;
  static constexpr Block kBefore = Block::kBeforeWorld;
  static constexpr Block kWorld = Block::kWorld;
  static constexpr auto kDirectives = std::to_array<Directive>({
      {"Accelerator", kBefore, &P::Accelerator},
      {"ActiveTransform", kAny, &P::ActiveTransform},
      {"AreaLightSource", kWorld, &P::AreaLightSource},
      {"Attribute", kAny, &P::Attribute},
      {"AttributeBegin", kWorld, &P::AttributeBegin},
      {"AttributeEnd", kWorld, &P::AttributeEnd},
      {"Camera", kBefore, &P::Camera},
      {"ColorSpace", kAny, &P::ColorSpace},
      {"ConcatTransform", kAny, &P::ConcatTransform},
      {"CoordSysTransform", kAny, &P::CoordSysTransform},
      {"CoordinateSystem", kAny, &P::CoordinateSystem},
      {"Film", kBefore, &P::Film},
      {"Identity", kAny, &P::Identity},
      {"Import", kWorld, &P::Import},
      {"Include", kAny, &P::Include},
      {"Integrator", kBefore, &P::Integrator},
      {"LightSource", kWorld, &P::LightSource},
      {"LookAt", kAny, &P::LookAt},
      {"MakeNamedMaterial", kWorld, &P::MakeNamedMaterial},
      {"MakeNamedMedium", kAny, &P::MakeNamedMedium},
      {"Material", kWorld, &P::Material},
      {"MediumInterface", kAny, &P::MediumInterface},
      {"NamedMaterial", kWorld, &P::NamedMaterial},
      {"ObjectBegin", kWorld, &P::ObjectBegin},
      {"ObjectEnd", kWorld, &P::ObjectEnd},
      {"ObjectInstance", kWorld, &P::ObjectInstance},
      {"Option", kAny, &P::Option},
      {"PixelFilter", kBefore, &P::PixelFilter},
      {"ReverseOrientation", kWorld, &P::ReverseOrientation},
      {"Rotate", kAny, &P::Rotate},
      {"Sampler", kBefore, &P::Sampler},
      {"Scale", kAny, &P::Scale},
      {"Shape", kWorld, &P::Shape},
      {"Texture", kWorld, &P::Texture},
      {"Transform", kAny, &P::SetTransform},
      {"TransformBegin", kWorld, &P::TransformBegin},
      {"TransformEnd", kWorld, &P::AttributeEnd},
      {"TransformTimes", kBefore, &P::SetTransformTimes},
      {"Translate", kAny, &P::Translate},
      {"WorldBegin", kBefore, &P::WorldBegin},
  });
};

std::span<const Directive> Directives() {
  return DirectiveTable::kDirectives;
}

}  // namespace tessera
