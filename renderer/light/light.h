// Lights: what emits, how to sample it from a point, and how to choose among many.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "color/wavelengths.h"
#include "language/scene_description.h"
#include "shape/geometry.h"
#include "shape/interaction.h"
#include "shape/shape_sampling.h"
#include "texture/texture_builder.h"

namespace tessera {

struct Light;  // light_kinds.h

// Light that arrives at a point from a sampled place.
struct LightSample {
  SampledSpectrum L;     // radiance (delta lights: radiance times the density they lack), unoccluded
  Vec3 wi;               // unit, towards the light
  float pdf = 0;         // per solid angle, without the probability of choosing this light; 1 for delta lights
  Point3 p;              // on the light; for lights at infinity a point outside the scene's sphere
  Vec3 p_error;
  Normal3 n;             // of an area light's surface; zero else
  bool is_delta = false;
};

struct ChosenLight {
  int light = 0;
  float pmf = 0;
};

// All lights of a scene with the structure that chooses among them. Immutable.
class LightTable {
 public:
  LightTable();
  ~LightTable();
  LightTable(LightTable&&) noexcept;
  LightTable& operator=(LightTable&&) noexcept;

  // Builds the LightSource directives, then one diffuse area light per primitive of every shape with an
  // AreaLightSource, writing its SurfaceProperties::area_light. `geometry` holds the shapes of `scene.shapes` in the same
  // order and must outlive the table. `light_sampler` is "uniform", "power" or "bvh".
  static Result<LightTable> Build(const SceneDescription& scene, const Transform& render_from_world,
                                  std::string_view light_sampler, TextureBuilder& textures, Geometry& geometry);

  // Chooses a light for a reference point; nothing if none can contribute. u in [0, 1).
  std::optional<ChosenLight> Choose(const ReferencePoint& reference, float u) const;
  // The probability with which Choose takes `light`.
  float ChoosePmf(const ReferencePoint& reference, int light) const;

  // Samples the light of index `light` from `reference`.
  std::optional<LightSample> Sample(int light, const ReferencePoint& reference, Point2 u,
                                    const SampledWavelengths& wavelengths) const;
  // The density per solid angle with which Sample would find the hit emitter along wi.
  float AreaLightPdf(int light, const ReferencePoint& reference, Vec3 wi, const SurfaceInteraction& on_light) const;
  float InfiniteLightPdf(int light, Vec3 wi) const;

  // Radiance that the emitter at a hit sends along wo.
  SampledSpectrum EmittedRadiance(int light, const SurfaceInteraction& on_light, Vec3 wo,
                                  const SampledWavelengths& wavelengths) const;
  // Radiance that arrives against direction d from a light at infinity.
  SampledSpectrum InfiniteRadiance(int light, Vec3 d, const SampledWavelengths& wavelengths) const;
  // Indices of the lights at infinity that rays can hit.
  std::span<const int> infinite_lights() const;
  size_t size() const;
  bool empty() const { return size() == 0; }

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace tessera
