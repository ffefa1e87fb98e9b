// A medium that is the same everywhere.
#pragma once

#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/math/ray.h"
#include "renderer/math/sampling.h"
#include "renderer/math/transform.h"
#include "renderer/medium/majorant.h"
#include "renderer/medium/phase_function.h"

namespace tessera {

class HomogeneousRay;

// A homogeneous medium at the wavelengths of a path.
struct HomogeneousCoefficients {
  SampledSpectrum sigma_a, sigma_s;  // per scene unit
  SampledSpectrum emission;          // sigma_a times emitted radiance

  HomogeneousRay RayAlong(const Ray& ray) const;
  const HomogeneousCoefficients* Homogeneous() const { return this; }
  bool MayCollide() const { return sigma_s[0] > 0; }
  float CollisionDistanceMax(float u) const { return SampleExponential(u, sigma_s[0]); }
};

// Its spectra are tables, so that a lookup costs the same for every kind of spectrum. Immutable.
class HomogeneousMedium {
 public:
  HomogeneousMedium() = default;  // a vacuum
  // Reads `preset`, `sigma_a`, `sigma_s`, `scale`, `Le`, `Lescale` and `g`; errors are remembered by the
  // reader. An unknown preset is a warning, and sigma_a and sigma_s apply, as in pbrt-v4.
  static HomogeneousMedium Read(ParameterReader& reader, const Transform& render_from_medium,
                                FileSource& files, Diagnostics& diagnostics);

  // If dispersion has dropped all wavelengths but the first, all four values are those of the first.
  HomogeneousCoefficients At(const SampledWavelengths& wavelengths) const;
  const PhaseFunction& phase() const { return phase_; }
  bool is_emissive() const { return is_emissive_; }

 private:
  DenseTable sigma_a_{}, sigma_s_{}, emission_{};
  PhaseFunction phase_;
  bool is_emissive_ = false;
};

// A medium ray (majorant.h) through a homogeneous medium: one uniform stretch. Scattering alone is left to
// chance: a medium that only absorbs is free of noise, and one that absorbs much more than it scatters nearly
// so. In return, Russian roulette, which looks at all wavelengths, must end the paths that absorption would
// have ended by chance.
class HomogeneousRay {
 public:
  explicit HomogeneousRay(const HomogeneousCoefficients& coefficients) : coefficients_(coefficients) {}

  bool Next(MajorantSegment* segment) {
    if (done_) return false;
    done_ = true;
    segment->sigma_a = coefficients_.sigma_a;
    segment->sigma_maj = coefficients_.sigma_s;
    segment->emission = coefficients_.emission;
    segment->uniform = true;
    return true;
  }
  MediumPoint At(float) const { return {SampledSpectrum(), coefficients_.sigma_s, SampledSpectrum()}; }

 private:
  const HomogeneousCoefficients& coefficients_;
  bool done_ = false;
};

inline HomogeneousRay HomogeneousCoefficients::RayAlong(const Ray&) const {
  return HomogeneousRay(*this);
}

}  // namespace tessera
