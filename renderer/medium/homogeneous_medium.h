// A medium that is the same everywhere.
#pragma once

#include <string>
#include <vector>

#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/medium/majorant.h"
#include "renderer/medium/phase_function.h"

namespace tessera {

// A homogeneous medium at four wavelengths.
struct MediumCoefficients {
  SampledSpectrum sigma_a, sigma_s;  // per scene unit
  SampledSpectrum emission;          // sigma_a times emitted radiance
};

// Its spectra are tables: a look-up costs the same whatever the scene gave. Immutable.
class HomogeneousMedium {
 public:
  // Reads `preset`, `sigma_a`, `sigma_s`, `scale`, `Le`, `Lescale` and `g`; errors are remembered by the
  // reader. An unknown preset is a warning, and the parameters count, as in pbrt-v4.
  static HomogeneousMedium Read(ParameterReader& reader, FileSource& files, Diagnostics& diagnostics);

  // Where dispersion has dropped all wavelengths but the first, all four are the first.
  MediumCoefficients At(const SampledWavelengths& wavelengths) const;
  const PhaseFunction& phase() const { return phase_; }
  bool is_emissive() const { return is_emissive_; }

 private:
  DenseTable sigma_a_{}, sigma_s_{}, emission_{};
  PhaseFunction phase_;
  bool is_emissive_ = false;
};

// The one stretch that a homogeneous medium shows to a ray. Scattering alone is left to chance: a medium that
// only absorbs is free of noise, and one that absorbs much more than it scatters nearly so. The price, paths
// that absorption would have ended by chance, is taken back by Russian roulette, which looks at all
// wavelengths.
class HomogeneousRay {
 public:
  explicit HomogeneousRay(const MediumCoefficients& coefficients) : coefficients_(coefficients) {}

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
  const MediumCoefficients& coefficients_;
  bool done_ = false;
};

}  // namespace tessera
