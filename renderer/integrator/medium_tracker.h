// A path's view of the media of its world.
#pragma once

#include "renderer/integrator/world.h"
#include "renderer/medium/flight.h"

namespace tessera {

// Follows rays through media. Keeps the coefficients of the medium it saw last, as most rays stay in one
// medium. A medium is an index into World::media, or -1 for a vacuum.
class MediumTracker {
 public:
  MediumTracker(const World& world, const SampledWavelengths& wavelengths, RayCounts& counts)
      : world_(world), wavelengths_(wavelengths), counts_(counts) {}

  // The coefficients of a medium that is not a vacuum; valid until the next call.
  const MediumCoefficients& In(int medium) {
    if (medium != known_) {
      coefficients_ = world_.media[medium].At(wavelengths_);
      known_ = medium;
    }
    return coefficients_;
  }
  // To be called when the wavelengths have changed.
  void Forget() { known_ = -1; }

  // The medium of a ray that leaves a surface along d and came to it through `medium`.
  static int Beyond(const SurfaceInteraction& interaction, Vec3 d, int medium) {
    if (interaction.inside_medium == interaction.outside_medium) return medium;
    return Dot(d, interaction.n) > 0 ? interaction.outside_medium : interaction.inside_medium;
  }

  // Follows a shadow ray that starts in `medium` to a sampled light. False if something is in the way; else
  // `weights` are those of FlyShadow.
  bool Reaches(Ray shadow, int medium, const LightSample& light, PathWeights* weights);

 private:
  void Attenuate(const Ray& shadow, int medium, float t, PathWeights* weights);

  const World& world_;
  const SampledWavelengths& wavelengths_;
  RayCounts& counts_;
  MediumCoefficients coefficients_;
  int known_ = -1;
};

}  // namespace tessera
