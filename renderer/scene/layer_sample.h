// What a layer sees of a sample.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "renderer/integrator/sample_record.h"
#include "renderer/integrator/world.h"
#include "renderer/scene/film_sensor.h"
#include "renderer/scene/light_groups.h"
#include "renderer/scene/mattes.h"

namespace tessera {

// Where the lobes of a surface are told apart.
enum Lobe : uint8_t { kDiffuseLobe, kSpecularLobe, kTransmissionLobe, kVolumeLobe };
constexpr size_t kLobeCount = 4;

// Light by the way that it took. As contributions of SampleRecorder.
struct ScatteredLight {
  SampledSpectrum all{0.0f};
  std::array<SampledSpectrum, kLobeCount> lobes{};  // by the first vertex
};

// A first hit that is kept.
struct SeenSurface {
  Hit hit;
  SurfaceInteraction interaction;
  float distance = 0;
  SampledSpectrum albedo;
};

// What a path has reported.
struct SampleParts {
  SampledSpectrum emission{0.0f};  // what the camera sees by itself
  ScatteredLight direct;           // scattered once
  ScatteredLight indirect;         // more often
  SampledSpectrum shadow{0.0f};
  SampledSpectrum transmittance{0.0f};  // 0 unless the camera ray leaves the scene
  std::optional<SeenSurface> surface;
  std::optional<MirroredSurface> mirrored;
  std::vector<SampledSpectrum> groups;  // of lights
};

// The space of the geometry in a film "gbuffer".
enum class GbufferSpace : uint8_t { kNone, kCamera, kWorld };

// How the radiance of a sample becomes a colour.
struct SampleExposure {
  const SampledWavelengths& wavelengths;  // when the path is complete
  float weight = 1;                       // of the radiance along the camera ray
  float limit = 1;                        // FilmSensor::Limit of the whole
};

// What layers know of the scene. Outlives all samples.
struct LayerScene {
  const World& world;
  const FilmSensor& sensor;
  const LightGroups& groups;
  const MatteTable& mattes;
  GbufferSpace gbuffer = GbufferSpace::kNone;
  float footprint_scale = 1;  // as PathSettings has it if textures are filtered
  TimeRange motion_times{};   // from when to when the layer "motion" looks
};

struct LayerSample {
  const LayerScene& scene;
  const SampleParts& parts;
  const SampledWavelengths& first_wavelengths;  // when the path started
  const SampleExposure& exposure;
  Rgb rgb;  // of the whole
  uint32_t index = 0;
  Point2 film;       // where the camera ray leaves the film, in pixels
  float time_s = 0;  // of the camera ray

  // So that the colours of parts sum to that of the whole.
  Rgb ColorOf(SampledSpectrum part) const {
    return scene.sensor.ToRgb(part * exposure.weight, exposure.wavelengths, exposure.limit);
  }
};

}  // namespace tessera
