#include "renderer/scene/scene_language.h"

#include "renderer/description/option_kinds.h"
#include "renderer/integrator/integrator_kinds.h"
#include "renderer/light/light.h"
#include "renderer/material/material_kinds.h"
#include "renderer/scene/film_settings.h"
#include "renderer/scene/scene_options.h"

namespace tessera {

std::vector<KindList> SceneLanguageKinds() {
  return {
      FilmKinds(),
      Integrators().List(),
      LightSourceKinds(),
      AreaLightKinds(),
      LightSamplers().List(),
      MaterialKinds().List(),
      SceneAcceleratorKinds(),
      OptionKinds().List(),
  };
}

}  // namespace tessera
