// A medium as a ray sees it: stretches with an upper bound of the density of collisions, and properties at
// points. A "medium ray" is any type with
//
//   bool Next(MajorantSegment* segment);   sets the next stretch along the ray; false after the last
//   MediumPoint At(float t) const;         called only within stretches that are not uniform
//
// Distances are in scene units along a unit direction, coefficients per scene unit, all at the wavelengths of
// the path.
#pragma once

#include <limits>

#include "renderer/color/sampled_spectrum.h"

namespace tessera {

struct MajorantSegment {
  float t_end = std::numeric_limits<float>::infinity();
  // Absorption that is constant over the stretch. It is accounted for in closed form, never by chance.
  SampledSpectrum sigma_a;
  // Upper bound of scattering plus absorption in excess of sigma_a.
  SampledSpectrum sigma_maj;
  // Power emitted per volume and solid angle on the whole stretch (sigma_a times Le). Zero unless uniform.
  SampledSpectrum emission;
  // Nothing varies: scattering equals sigma_maj everywhere, so that no collision is null and the
  // transmittance is known.
  bool uniform = false;
};

// The properties at a point of a stretch that is not uniform.
struct MediumPoint {
  SampledSpectrum sigma_a;  // in excess of that of the stretch
  SampledSpectrum sigma_s;
  SampledSpectrum emission;  // per volume and solid angle
};

}  // namespace tessera
