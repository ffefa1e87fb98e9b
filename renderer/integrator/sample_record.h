// What a path yields: contributions to the radiance of its sample, and the surface that its camera ray sees.
// Integrators report both to a sink, a type known at compile time with
//
//   static constexpr bool kRecords;                                 whether it looks at more than the sum
//   void Add(SampledSpectrum contribution, const LightPath& path);
//   void ReachFirstSurface(const PathContext& context, const Hit& hit, const SurfaceInteraction&
//   interaction);
//
// There are two: RadianceSink, which costs no more than a sum, and RecordingSink, which passes everything on.
#pragma once

#include <cstdint>

#include "renderer/color/sampled_spectrum.h"
#include "renderer/integrator/path_context.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// How light was scattered at the first vertex of a path, seen from the camera.
enum class FirstScatter : uint8_t {
  kNone,         // the camera sees the emitter
  kNonSpecular,  // by the diffuse and glossy lobes of a surface, which are evaluated together
  kSpecular,
  kMedium,
};

// The way from an emitter to the camera.
struct LightPath {
  static constexpr int kMediumEmission = -1;

  int light = kMediumEmission;  // index into World::lights
  int depth = 0;                // scattering events between the emitter and the camera
  FirstScatter first = FirstScatter::kNone;
};

// The first surface along a camera ray that is not an `interface`, with what denoisers and compositing ask
// for. Not reported if the ray misses all, or scatters in a medium before. The references are valid during
// the call.
struct FirstHit {
  const Hit& hit;                     // names instance, shape and primitive
  const SurfaceInteraction& surface;  // in rendering space; the shading normal includes bump and normal maps
  float distance = 0;                 // from where the camera ray starts, in scene units
  // The share of even light from all around that the surface sends along the ray, at the path's wavelengths.
  SampledSpectrum albedo;
};

// Receives the parts of samples. Used by one thread at a time.
class SampleRecorder {
 public:
  virtual ~SampleRecorder() = default;
  // The contributions of a path sum to its radiance. As that, each is to be divided by the densities that the
  // wavelengths have when the path is complete.
  virtual void Add(SampledSpectrum contribution, const LightPath& path) = 0;
  // At most once a path.
  virtual void AddFirstHit(const FirstHit& first) = 0;
};

struct RadianceSink {
  static constexpr bool kRecords = false;

  void Add(SampledSpectrum contribution, const LightPath&) { radiance += contribution; }
  void ReachFirstSurface(const PathContext&, const Hit&, const SurfaceInteraction&) {}

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
  // Leaves interaction and wavelengths as they are.
  void ReachFirstSurface(const PathContext& context, const Hit& hit, const SurfaceInteraction& interaction);

  SampledSpectrum radiance{0.0f};

 private:
  Point3 origin_;
  SampleRecorder& recorder_;
};

}  // namespace tessera
