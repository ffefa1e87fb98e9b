#include "renderer/scene/scene_language.h"

#include "renderer/camera/camera.h"
#include "renderer/description/option_kinds.h"
#include "renderer/filter/filter.h"
#include "renderer/integrator/integrator_kinds.h"
#include "renderer/light/light.h"
#include "renderer/material/material_kinds.h"
#include "renderer/medium/medium.h"
#include "renderer/sampler/sampler_settings.h"
#include "renderer/scene/film_settings.h"
#include "renderer/scene/scene_options.h"
#include "renderer/shape/shape_kinds.h"
#include "renderer/texture/texture_kinds.h"

namespace tessera {

std::vector<KindList> SceneLanguageKinds() {
  return {
      CameraKinds(),           FilmKinds(),
      FilterKinds(),           SamplerKinds(),
      Integrators().List(),    LightSamplers().List(),
      SceneAcceleratorKinds(), ShapeKinds().List(),
      MaterialKinds().List(),  FloatTextureKinds(),
      SpectrumTextureKinds(),  MediumKinds(),
      LightSourceKinds(),      AreaLightKinds(),
      OptionKinds().List(),
  };
}

}  // namespace tessera
