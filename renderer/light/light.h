// The lights of a scene: radiance they emit, sampling one from a point, choosing one of many.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "renderer/color/wavelengths.h"
#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"
#include "renderer/image/image.h"
#include "renderer/light/emission_image.h"
#include "renderer/light/light_choice.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"
#include "renderer/shape/shape_sampling.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Light that arrives at a point from a sampled place.
struct LightSample {
  // Radiance (of delta lights: radiance times the density they lack), unoccluded. To be asked for as late as
  // possible: a texel is far away in memory, and most samples of the sky are occluded.
  SampledSpectrum Radiance(const SampledWavelengths& wavelengths) const {
    return map == nullptr ? L : map->Sample(texel_x, texel_y, wavelengths);
  }
  // Whether Radiance is known to be zero without a lookup.
  bool IsDark() const { return map == nullptr && !AnyNonZero(L); }

  SampledSpectrum L;                 // without a map
  const EmissionMap* map = nullptr;  // of a light at infinity that is a picture
  uint32_t texel_x = 0, texel_y = 0;
  Vec3 wi;  // unit, towards the light
  // Per solid angle, without the probability of choosing this light; 1 for points and directions.
  float pdf = 0;
  Point3 p;  // on the light; for lights at infinity a point outside the scene's sphere
  Vec3 p_error;
  Normal3 n;  // of an area light's surface; otherwise zero
  // No scattered ray can hit it (also a surface that they pass): light sampling has the weight 1.
  bool is_delta = false;
};

// A shape with an AreaLightSource.
struct EmittingShape {
  const ShapeDescription* description = nullptr;
  uint32_t shape = 0;                    // as Hit::shape
  uint32_t instance = Hit::kNoInstance;  // of one that moves
};

// What a LightTable is built from.
struct LightInputs {
  const SceneDescription& scene;
  std::span<const EmittingShape> emitters;
  const Transform& render_from_world;
  LightSamplerKind light_sampler = LightSamplerKind::kTree;
  FileSource& files;
  ImageCache& images;
  // For the alpha of emitters. Complete; must outlive the table at this address.
  const TextureTable& textures;
  bool samples_all = false;  // LightContext::samples_all
};

struct BuiltLights;
class RectangleEmitter;

// A light that is a rectangle and emits the same everywhere.
struct RectangleLight {
  const RectangleEmitter* emitter;
  const Spectrum* L;  // radiance, to be multiplied by `scale`
  float scale;
  bool two_sided;
  bool is_delta;  // as LightSample::is_delta
};

// All lights of a scene with the structure that chooses among them. Immutable.
//
// Unless samples_all, some light is never chosen or sampled, as directions sampled from surfaces find it with
// less noise: constant lights at infinity, and the part of an environment map that is darker than its mean
// (Karlik et al. 2019, "MIS Compensation"). So an integrator must also count what rays find that hit emitters
// or leave the scene.
class LightTable {
 public:
  struct Data;  // light_data.h

  LightTable();
  ~LightTable();
  LightTable(LightTable&&) noexcept;
  LightTable& operator=(LightTable&&) noexcept;

  // Builds the LightSource directives in their order, then one area light per primitive of every emitter.
  // `geometry` must outlive the table and stay where it is; the area_light of its shapes is not used.
  static Result<BuiltLights> Build(const LightInputs& inputs, const Geometry& geometry,
                                   Diagnostics& diagnostics);

  // Chooses a light for a reference point. Returns nullopt if none can contribute. u in [0, 1).
  std::optional<ChosenLight> Choose(const ReferencePoint& reference, float u) const;
  // What Choose returns, if that is the same everywhere; nullopt if not.
  std::optional<ChosenLight> OnlyLight() const;
  // The probability with which Choose takes `light`, or the light that is sampled for it: that of the first
  // half of a rectangle stands for both triangles.
  float ChoosePmf(const ReferencePoint& reference, int light) const;

  // Around `light`, or the light that is sampled for it; nullopt for lights at infinity, and for all lights
  // unless the light sampler is the tree.
  std::optional<BoundingSphere> SphereOf(int light) const;
  bool has_spheres() const;
  // Chooses one of the lights that have a sphere, for what a medium scatters along a ray, whose direction is
  // of unit length. `extinction` is that of the medium, per scene unit. Returns nullopt with the probability
  // that other lights light the ray, and if no light has a sphere. u in [0, 1).
  std::optional<ChosenLight> ChooseAlong(const Ray& ray, float extinction, float u) const;
  // The probability with which ChooseAlong takes `light`, or the light that is sampled for it.
  float ChoosePmfAlong(const Ray& ray, float extinction, int light) const;

  // Samples the light of index `light` from `reference`. Returns nullopt if no light arrives.
  std::optional<LightSample> Sample(int light, const ReferencePoint& reference, Point2 u,
                                    const SampledWavelengths& wavelengths) const;
  // The point on the surface of area light `light` that Sample takes. Returns nullopt if it cannot be seen.
  std::optional<ShapeSample> SamplePoint(int light, const ReferencePoint& reference, Point2 u) const;
  // What Sample of `light` samples, if it is a rectangle; nullopt if not.
  std::optional<RectangleLight> RectangleOf(int light) const;
  // The density per solid angle with which Sample, of `light` or of the light that is sampled for it, would
  // find the hit emitter along wi.
  float AreaLightPdf(int light, const ReferencePoint& reference, Vec3 wi,
                     const SurfaceInteraction& on_light) const;
  float InfiniteLightPdf(int light, Point3 from, Vec3 wi, float time_s) const;

  // Radiance that the emitter at a hit sends along wo.
  SampledSpectrum EmittedRadiance(int light, const SurfaceInteraction& on_light, Vec3 wo,
                                  const SampledWavelengths& wavelengths) const;
  // Radiance that arrives at `from`, where the path last scattered, against unit direction d from a light at
  // infinity.
  SampledSpectrum InfiniteRadiance(int light, Point3 from, Vec3 d, float time_s,
                                   const SampledWavelengths& wavelengths) const;
  // Whether scattered rays can find the light; if not, only light sampling can.
  bool IsHitByScatteredRays(int light) const;
  // The indices of all lights at infinity that rays can hit.
  std::span<const int> infinite_lights() const;
  size_t size() const;
  bool empty() const { return size() == 0; }

 private:
  // The index of the light that is sampled for `light`.
  int SampledFor(int light) const;

  std::unique_ptr<Data> data_;
};

struct BuiltLights {
  LightTable table;
  // For each emitter: SurfaceProperties::area_light.
  std::vector<int> area_lights;
};

// The kinds of LightSource and AreaLightSource.
KindList LightSourceKinds();
KindList AreaLightKinds();

}  // namespace tessera
