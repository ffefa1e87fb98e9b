// Path tracing with one ray per vertex: a direction is drawn half from the surface's BSDF, half towards the
// lights, and weighted by the density of that mixture; there are no shadow rays, light is what the rays hit
// (P. Shirley, "Ray Tracing: The Rest of Your Life"). It is Veach and Guibas's one-sample model of multiple
// importance sampling with the balance heuristic (1995). Specular lobes bypass the mixture. There is no
// Russian roulette: paths end at the depth limit, or when they are absorbed.
#pragma once

#include "renderer/integrator/light_directions.h"
#include "renderer/integrator/sample_record.h"

namespace tessera {

// The direction that the mixture draws at one vertex.
struct MixtureSample {
  SampledSpectrum weight;  // of the radiance that arrives: f |cos| / density
  Ray ray;                 // starts at the vertex
  // Per solid angle, of the mixture; of a specular sample: the probability of the choice.
  float density = 0;
  bool is_specular = false;
};

// Draws at a surface from u_choice (technique, and light or lobe) and u, all in [0, 1). Returns nullopt if
// the light is absorbed.
std::optional<MixtureSample> SampleMixture(const LightDirections& lights,
                                           const SurfaceInteraction& interaction, const Bsdf& bsdf,
                                           float u_choice, Point2 u, const SampledWavelengths& wavelengths);
// The density per solid angle of its directions that are not specular; `wi` is of unit length.
float MixturePdf(const LightDirections& lights, const SurfaceInteraction& interaction, const Bsdf& bsdf,
                 Vec3 wi, const SampledWavelengths& wavelengths);

// The same for light that came along `ray` to its origin, where a medium scatters it. Its weights leave out
// the medium's coefficient.
std::optional<MixtureSample> SampleMixture(const LightDirections& lights, const Ray& ray,
                                           const PhaseFunction& phase, float u_choice, Point2 u,
                                           const SampledWavelengths& wavelengths);
float MixturePdf(const LightDirections& lights, const Ray& ray, const PhaseFunction& phase, Vec3 wi,
                 const SampledWavelengths& wavelengths);

// As TracePath. Lights that no ray can hit (points, spots, distant ones) contribute nothing.
template <typename Sink>
void TraceMixture(const PathContext& context, const LightDirections& lights, const Ray& camera_ray,
                  Sink& sink);

}  // namespace tessera
