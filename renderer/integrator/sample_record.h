// What a path yields: contributions to the radiance of its sample, and the surface that its camera ray sees.
// Integrators report both to a sink, a type known at compile time with
//
//   static constexpr bool kRecords;                                 whether it looks at more than the sum
//   void Add(SampledSpectrum contribution, const LightPath& path);
// and, if kRecords,
//   void ReachFirstSurface(const PathContext& context, const Hit& hit, const SurfaceInteraction&
//   interaction);
//   void ReachNextSurface(const PathContext& context, const SurfaceInteraction& interaction,
//                         SampledSpectrum throughput);      after nothing but specular scattering
//   void AddShadow(SampledSpectrum blocked);
//   void Escape(SampledSpectrum transmittance);
//   const RecordNeeds& needs() const;
//
// There are two: RadianceSink, which costs no more than a sum, and RecordingSink, which passes everything on.
#pragma once

#include <cstdint>

#include "renderer/bxdf/bsdf.h"
#include "renderer/color/sampled_spectrum.h"
#include "renderer/integrator/path_context.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// How light was scattered at the first vertex of a path, seen from the camera.
enum class FirstScatter : uint8_t {
  kNone,          // the camera sees the emitter
  kReflection,    // by a surface, or below it
  kTransmission,  // through a surface
  kMedium,
};

struct FirstVertex {
  FirstScatter scatter = FirstScatter::kNone;
  // Of light that was reflected: the share of diffuse lobes and of what was scattered below the surface. The
  // rest is that of glossy and specular lobes, which are evaluated together with the diffuse ones.
  SampledSpectrum diffuse{0.0f};
};

// The first vertex of a path that a surface scatters from wi to wo, which are unit vectors away from it.
inline FirstVertex FirstVertexAt(const Bsdf& bsdf, Vec3 wo, Vec3 wi, bool is_specular) {
  if (!bsdf.IsReflection(wo, wi)) return {FirstScatter::kTransmission};
  return {FirstScatter::kReflection, is_specular ? SampledSpectrum(0.0f) : bsdf.DiffuseShare(wo, wi)};
}

// The way from an emitter to the camera.
struct LightPath {
  static constexpr int kMediumEmission = -1;

  int light = kMediumEmission;  // index into World::lights
  int depth = 0;                // scattering events between the emitter and the camera
  FirstVertex first;
};

// The first surface along a camera ray that is not an `interface`, with what denoisers and compositing ask
// for. Not reported if the ray misses all, or scatters in a medium before. The references are valid during
// the call.
struct FirstHit {
  const Hit& hit;                     // names instance, shape and primitive
  const SurfaceInteraction& surface;  // in rendering space; the shading normal includes bump and normal maps
  float distance = 0;                 // from where the camera ray starts, in scene units
  // The share of even light from all around that the surface sends along the ray, at the path's wavelengths;
  // 0 if it is not needed.
  SampledSpectrum albedo;
};

// What is seen in mirrors and through clear glass: the first surface along the path that does not only
// reflect and refract perfectly.
struct MirroredSurface {
  Normal3 n;  // of shading, in rendering space, towards where the path comes from
  // As that of FirstHit, times the share of light that reaches the camera from there; 0 if it is not needed.
  SampledSpectrum albedo;
};

// What a recorder looks at. What it does not need may be left out.
struct RecordNeeds {
  bool surface = false;  // the first hit
  bool albedo = false;   // of the first hit and of what is mirrored
  bool lobes = false;    // LightPath::first
  bool shadow = false;
  bool mirrored = false;  // MirroredSurface; needs `surface`

  constexpr RecordNeeds operator|(const RecordNeeds& other) const {
    return {surface || other.surface, albedo || other.albedo, lobes || other.lobes, shadow || other.shadow,
            mirrored || other.mirrored};
  }
};

// Receives the parts of samples. Used by one thread at a time.
class SampleRecorder {
 public:
  explicit SampleRecorder(const RecordNeeds& needs) : needs_(needs) {}
  virtual ~SampleRecorder() = default;
  const RecordNeeds& needs() const { return needs_; }
  // The contributions of a path sum to its radiance. As that, each is to be divided by the densities that the
  // wavelengths have when the path is complete.
  virtual void Add(SampledSpectrum contribution, const LightPath& path) = 0;
  // At most once a path.
  virtual void AddFirstHit(const FirstHit& first) = 0;
  // At most once a path, after its first hit: if that is perfectly specular and a surface is found that is
  // not.
  virtual void AddMirrored(const MirroredSurface& mirrored) = 0;
  // The light of a light source that would be scattered at the first vertex if nothing were in between, as
  // light sampling alone estimates it. In the units of contributions, but no part of the radiance.
  virtual void AddShadow(SampledSpectrum blocked) = 0;
  // The camera ray leaves the scene. `transmittance`: what media on the way let through. At most once a path.
  virtual void Escape(SampledSpectrum transmittance) = 0;

 protected:
  RecordNeeds needs_;
};

struct RadianceSink {
  static constexpr bool kRecords = false;

  void Add(SampledSpectrum contribution, const LightPath&) { radiance += contribution; }

  SampledSpectrum radiance{0.0f};
};

class RecordingSink {
 public:
  static constexpr bool kRecords = true;

  RecordingSink(const Ray& camera_ray, SampleRecorder& recorder)
      : origin_(camera_ray.o), recorder_(recorder) {}

  void Add(SampledSpectrum contribution, const LightPath& path) {
    radiance += contribution;
    recorder_.Add(contribution, path);
  }
  void AddShadow(SampledSpectrum blocked) { recorder_.AddShadow(blocked); }
  void Escape(SampledSpectrum transmittance) { recorder_.Escape(transmittance); }
  const RecordNeeds& needs() const { return recorder_.needs(); }
  // Leaves interaction, wavelengths and sampler as they are.
  void ReachFirstSurface(const PathContext& context, const Hit& hit, const SurfaceInteraction& interaction);
  // The same.
  void ReachNextSurface(const PathContext& context, const SurfaceInteraction& interaction,
                        SampledSpectrum throughput) {
    if (seeks_mirrored_) SeekMirrored(context, interaction, throughput);
  }

  SampledSpectrum radiance{0.0f};

 private:
  void SeekMirrored(const PathContext& context, const SurfaceInteraction& interaction,
                    SampledSpectrum throughput);

  Point3 origin_;
  SampleRecorder& recorder_;
  bool seeks_mirrored_ = false;  // all surfaces so far were perfectly specular
};

}  // namespace tessera
