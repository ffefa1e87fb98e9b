// The contents of a LightTable.
#pragma once

#include <variant>

#include "renderer/light/area_lights.h"
#include "renderer/light/delta_lights.h"
#include "renderer/light/infinite_lights.h"
#include "renderer/light/light.h"
#include "renderer/light/light_chooser.h"
#include "renderer/light/light_motion.h"
#include "renderer/light/portal_light.h"
#include "renderer/light/projector_lights.h"

namespace tessera {

// A LightSource directive: one of the kinds that light_kind.h describes.
using SourceLight = std::variant<PointLight, SpotLight, DistantLight, GoniometricLight, ProjectionLight,
                                 ConstantInfiniteLight, ImageInfiniteLight, PortalInfiniteLight>;

struct LightTable::Data {
  std::vector<SourceLight> sources;  // lights 0, 1, ...
  // Of each source; null if it stands still. Empty if all do.
  std::vector<std::unique_ptr<const LightMotion>> motions;
  AreaLights areas;           // the lights after them
  std::vector<int> infinite;  // those of `sources` that rays can hit
  LightChooser chooser;
  const TextureTable* textures = nullptr;
  float scene_radius = 0;  // of a sphere around all geometry

  const SourceLight& Source(int light) const { return sources[static_cast<size_t>(light)]; }
  // Null if the source stands still.
  const LightMotion* MotionOf(int light) const {
    return motions.empty() ? nullptr : motions[static_cast<size_t>(light)].get();
  }
  bool IsSource(int light) const { return static_cast<size_t>(light) < sources.size(); }
  size_t AreaIndex(int light) const { return static_cast<size_t>(light) - sources.size(); }
  int AreaLight(size_t area) const { return static_cast<int>(sources.size() + area); }
};

}  // namespace tessera
