// The way of a path below a surface: from where it enters to where it comes out.
#pragma once

#include <optional>

#include "renderer/bxdf/bsdf.h"
#include "renderer/color/sampled_spectrum.h"
#include "renderer/integrator/path_context.h"

namespace tessera {

struct SubsurfaceExit {
  SurfaceInteraction interaction;  // where the path comes out; wo is the shading normal
  Bsdf bsdf;                       // of light that enters there
  SampledSpectrum weight;          // what is scattered from there over the density of finding it
  SampledSpectrum densities;       // of finding it by each wavelength, relative to the first
};

// Samples a probe segment around `entry`, at which SubsurfaceAt applies, and one of the points where it meets
// the same material. Takes four dimensions of the sampler. Returns nullopt if the light is absorbed.
// `is_subsurface` is false if the material that a mix chose has no inside.
std::optional<SubsurfaceExit> SampleSubsurface(const PathContext& context, const SurfaceInteraction& entry,
                                               bool* is_subsurface);

}  // namespace tessera
