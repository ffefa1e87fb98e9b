// The inside of a Scene, for the files that build it and render from it.
#pragma once

#include <string>

#include "camera/camera.h"
#include "film/frame_spec.h"
#include "filter/filter.h"
#include "integrator/estimator.h"
#include "integrator/world.h"
#include "sampler/sampler_settings.h"
#include "scene/film_sensor.h"
#include "scene/scene.h"

namespace tessera {

// Immutable once Load has returned it.
struct Scene::Data {
  World world;
  Filter filter;
  SamplerSettings sampler;
  Estimator estimator;
  FilmSensor sensor{ColorSpace::Srgb(), 1, 0, 1};
  FrameSpec frame;
  SceneSummary summary;
};

}  // namespace tessera
