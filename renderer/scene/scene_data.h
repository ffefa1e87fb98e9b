// The contents of a Scene, for the files that build it and render from it.
#pragma once

#include <string>

#include "renderer/camera/camera.h"
#include "renderer/film/frame_spec.h"
#include "renderer/filter/filter.h"
#include "renderer/integrator/estimator.h"
#include "renderer/integrator/world.h"
#include "renderer/sampler/sampler_settings.h"
#include "renderer/scene/film_sensor.h"
#include "renderer/scene/frame_attributes.h"
#include "renderer/scene/layer_sample.h"
#include "renderer/scene/light_groups.h"
#include "renderer/scene/mattes.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/spectral_buckets.h"

namespace tessera {

// Immutable once Load has returned it.
struct Scene::Data {
  World world;
  Filter filter;
  SamplerSettings sampler;
  Estimator estimator;
  FilmSensor sensor = FilmSensor::Observer(ColorSpace::Srgb(), {}, 0);
  FrameSpec frame;
  FrameAttributes frame_attributes;
  SpectralBuckets buckets;
  LightGroups light_groups;
  GbufferSpace gbuffer = GbufferSpace::kNone;
  float footprint_scale = 1;      // of the film "gbuffer"
  TimeRange motion_times;         // of the layer "motion"
  bool is_moment = false;         // all rays have the time at which the shutter opens
  bool pixel_jitter = true;       // else samples are at the centres of pixels and of the lens
  bool wavelength_jitter = true;  // else all samples have the same wavelengths
  std::set<std::string> layers;   // in the frame: names in Layers()
  MatteTable mattes;              // empty unless a layer needs it
  SceneSummary summary;
};

}  // namespace tessera
