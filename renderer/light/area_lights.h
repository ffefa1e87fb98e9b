// Surfaces that emit: one emitter per shape, one light per primitive of it. Two triangles that form a
// rectangle are two lights, of which the first is sampled for both.
#pragma once

#include <optional>
#include <vector>

#include "renderer/color/spectrum.h"
#include "renderer/light/emission_image.h"
#include "renderer/light/light.h"
#include "renderer/light/light_chooser.h"
#include "renderer/light/rectangle_emitter.h"

namespace tessera {

// What the primitives of one shape share.
struct AreaEmitter {
  const Shape* shape = nullptr;
  const MovingTransform* render_from_shape = nullptr;  // null: the shape lies in rendering space
  TimeRange times;                                     // of all rays
  Spectrum L;                                          // radiance; with a picture: of its white
  RgbImage image;                                      // over (u, 1 - v); empty: L alone
  float image_scale = 1;
  bool two_sided = false;
  bool has_alpha = false;  // alpha lets only a part of the light out
  // Alpha is 0 everywhere: rays pass, but the surface emits fully, so only light sampling finds it.
  bool is_hidden = false;
  // Scattered rays pass the surface: only light sampling finds it from where they were scattered.
  bool is_passed = false;

  bool IsHitByScatteredRays() const { return !is_hidden && !is_passed; }
  // Whether what it emits depends on texture coordinates.
  bool NeedsUv() const { return !image.empty() || has_alpha; }
};

// One primitive of an emitting shape.
struct AreaLight {
  static constexpr uint32_t kNoRectangle = 0xffffffffu;

  uint32_t emitter = 0;
  uint32_t primitive = 0;
  float scale = 1;                    // of L: `power` is per primitive, and their areas differ
  uint32_t rectangle = kNoRectangle;  // that it is a half of
  bool is_second_half = false;

  bool IsInRectangle() const { return rectangle != kNoRectangle; }
};

class AreaLights {
 public:
  // Reads the AreaLightSource of a shape and adds a light for each of its primitives.
  Result<void> Add(const EmittingShape& emitting, const Geometry& geometry, FileSource& files,
                   ImageCache& images, Diagnostics& diagnostics);

  size_t size() const { return lights_.size(); }
  // The light that is chosen and sampled for `light`: itself, or the other half of its rectangle.
  size_t SampledFor(size_t light) const { return lights_[light].is_second_half ? light - 1 : light; }
  // A point on the light, or on the rectangle that it is the first half of, as Sample takes it.
  std::optional<ShapeSample> SamplePoint(size_t light, const ReferencePoint& reference, Point2 u) const;
  std::optional<LightSample> Sample(size_t light, const ReferencePoint& reference, Point2 u,
                                    const SampledWavelengths& wavelengths,
                                    const TextureTable& textures) const;
  // As LightTable::RectangleOf.
  std::optional<RectangleLight> RectangleOf(size_t light) const {
    const AreaLight& area = lights_[light];
    if (!area.IsInRectangle()) return std::nullopt;
    const AreaEmitter& emitter = emitters_[area.emitter];
    return RectangleLight{&rectangles_[area.rectangle], &emitter.L, area.scale, emitter.two_sided,
                          !emitter.IsHitByScatteredRays()};
  }
  // With which SamplePoint of SampledFor(light) finds a point on the light.
  float Pdf(size_t light, const ReferencePoint& reference, Vec3 wi, const SurfaceInteraction& on_light) const;
  // Radiance along wo from a point that a ray hit.
  SampledSpectrum Radiance(size_t light, const SurfaceInteraction& on_light, Vec3 wo,
                           const SampledWavelengths& wavelengths) const {
    const AreaLight& area = lights_[light];
    const AreaEmitter& emitter = emitters_[area.emitter];
    if (!emitter.two_sided && Dot(on_light.n, wo) < 0) return SampledSpectrum();
    return Emission(emitter, area, on_light.uv, wavelengths);
  }
  bool IsHitByScatteredRays(size_t light) const {
    return emitters_[lights_[light].emitter].IsHitByScatteredRays();
  }
  // Appends the profile of each light, in order.
  void AddProfiles(std::vector<LightProfile>* profiles) const;

 private:
  static SampledSpectrum Emission(const AreaEmitter& emitter, const AreaLight& area, Point2 uv,
                                  const SampledWavelengths& wavelengths) {
    const SampledSpectrum L =
        emitter.image.empty() ? emitter.L.Sample(wavelengths) : ImageEmission(emitter, uv, wavelengths);
    return L * area.scale;
  }
  static SampledSpectrum ImageEmission(const AreaEmitter& emitter, Point2 uv,
                                       const SampledWavelengths& wavelengths);

  void JoinRectangles(size_t first);
  LightProfile ProfileOf(const AreaLight& light, float strength) const;

  std::vector<AreaEmitter> emitters_;
  std::vector<AreaLight> lights_;
  std::vector<RectangleEmitter> rectangles_;
};

}  // namespace tessera
