// Lights: what emits, how to sample it from a point, and how to choose among many.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "renderer/color/wavelengths.h"
#include "renderer/description/scene_description.h"
#include "renderer/image/image.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/shape_sampling.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Light that arrives at a point from a sampled place.
struct LightSample {
  SampledSpectrum L;  // radiance (delta lights: radiance times the density they lack), unoccluded
  Vec3 wi;            // unit, towards the light
  float pdf =
      0;     // per solid angle, without the probability of choosing this light; 1 for points and directions
  Point3 p;  // on the light; for lights at infinity a point outside the scene's sphere
  Vec3 p_error;
  Normal3 n;  // of an area light's surface; zero else
  bool is_delta =
      false;  // no ray can hit it (also a surface of alpha 0): do not weight it against other techniques
};

struct ChosenLight {
  int light = 0;
  float pmf = 0;
};

// What a LightTable is built from.
struct LightInputs {
  const SceneDescription& scene;
  // The description of each entry of Geometry::shapes.
  std::span<const ShapeDescription* const> shape_sources;
  const Transform& render_from_world;
  std::string_view light_sampler;  // "uniform", "power" or "bvh"
  FileSource& files;
  ImageCache& images;
  // For the alpha of emitters. Finished, and must outlive the table at this address.
  const TextureTable& textures;
};

// All lights of a scene with the structure that chooses among them. Immutable.
//
// What Choose and Sample never take, because directions sampled from surfaces find it better, has probability
// 0 everywhere: a constant light at infinity, and the part of an environment map that is darker than its mean
// (Karlik et al. 2019, "MIS Compensation"). So an integrator must also follow rays that miss or hit emitters.
class LightTable {
 public:
  struct Data;  // light_data.h

  LightTable();
  ~LightTable();
  LightTable(LightTable&&) noexcept;
  LightTable& operator=(LightTable&&) noexcept;

  // Builds the LightSource directives, then one diffuse area light per primitive of every shape with an
  // AreaLightSource, writing its SurfaceProperties::area_light. The is_interface flag and alpha of all
  // surfaces must be set already. The shapes of `geometry` must outlive the table and stay where they are.
  // Adds to `diagnostics`.
  static Result<LightTable> Build(const LightInputs& inputs, Geometry& geometry, Diagnostics& diagnostics);

  // Chooses a light for a reference point; nothing if none can contribute. u in [0, 1).
  std::optional<ChosenLight> Choose(const ReferencePoint& reference, float u) const;
  // The probability with which Choose takes `light`.
  float ChoosePmf(const ReferencePoint& reference, int light) const;

  // Samples the light of index `light` from `reference`. Nothing if no light arrives.
  std::optional<LightSample> Sample(int light, const ReferencePoint& reference, Point2 u,
                                    const SampledWavelengths& wavelengths) const;
  // The density per solid angle with which Sample would find the hit emitter along wi.
  float AreaLightPdf(int light, const ReferencePoint& reference, Vec3 wi,
                     const SurfaceInteraction& on_light) const;
  float InfiniteLightPdf(int light, Vec3 wi) const;

  // Radiance that the emitter at a hit sends along wo.
  SampledSpectrum EmittedRadiance(int light, const SurfaceInteraction& on_light, Vec3 wo,
                                  const SampledWavelengths& wavelengths) const;
  // Radiance that arrives against unit direction d from a light at infinity.
  SampledSpectrum InfiniteRadiance(int light, Vec3 d, const SampledWavelengths& wavelengths) const;
  // Indices of the lights at infinity that rays can hit.
  std::span<const int> infinite_lights() const;
  size_t size() const;
  bool empty() const { return size() == 0; }

 private:
  std::unique_ptr<Data> data_;
};

}  // namespace tessera
