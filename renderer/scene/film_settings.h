// What the Film directive asks for, with the overrides of the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "renderer/description/diagnostics.h"
#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"
#include "renderer/film/frame_spec.h"
#include "renderer/scene/film_sensor.h"
#include "renderer/scene/layer_sample.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/spectral_buckets.h"

namespace tessera {

struct FilmSettings {
  int width = 1280, height = 720;
  PixelBounds crop;
  float diagonal_mm = 35;  // of the sensor
  std::string sensor;      // "cie1931" or one of SensorNames()
  float iso = 100;
  float white_balance = 0;  // kelvin; 0: none
  float component_max = 0;  // largest sensor component of one sample; infinite if there is no clamp
  ExrType exr_type = ExrType::kHalf;
  SpectralBuckets buckets;
  GbufferSpace gbuffer = GbufferSpace::kNone;
  std::set<std::string> layers;  // of AovNames
  std::optional<uint32_t> cryptomatte_levels;

  // `exposure_time` in seconds. The colour space must outlive the sensor.
  FilmSensor MakeSensor(const ColorSpace& color_space, float exposure_time) const;
};

KindList FilmKinds();

// Warns, as pbrt does, of a crop that the film does not hold.
Result<FilmSettings> ReadFilm(const Entity& entity, const RenderOptions& options, Diagnostics& diagnostics);

}  // namespace tessera
