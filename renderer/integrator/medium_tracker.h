// A path's view of the media of its world.
#pragma once

#include "renderer/integrator/path_context.h"
#include "renderer/medium/flight.h"

namespace tessera {

// Follows rays through media. Caches the coefficients of the last medium, as most rays stay in one medium. A
// medium is an index into World::media, or -1 for a vacuum.
class MediumTracker {
 public:
  // `context` must outlive this.
  explicit MediumTracker(const PathContext& context) : context_(context) {}

  // The coefficients of a medium that is not a vacuum; valid until the next call.
  const MediumCoefficients& In(int medium) {
    if (medium != known_) {
      coefficients_ = context_.world.media[medium].At(context_.wavelengths);
      known_ = medium;
    }
    return coefficients_;
  }
  // Must be called when the wavelengths have changed.
  void Forget() { known_ = -1; }

  // The medium of a ray that leaves a surface along d after it came to it through `medium`.
  static int Beyond(const SurfaceInteraction& interaction, Vec3 d, int medium) {
    if (interaction.inside_medium == interaction.outside_medium) return medium;
    return Dot(d, interaction.n) > 0 ? interaction.outside_medium : interaction.inside_medium;
  }

  // Follows a shadow ray that starts in `medium` to a sampled light. Returns false if something is in the
  // way; otherwise `weights` are those of FlyShadow.
  bool Reaches(Ray shadow, int medium, const LightSample& light, PathWeights* weights);

 private:
  void Attenuate(const Ray& shadow, int medium, float t, PathWeights* weights);

  const PathContext& context_;
  MediumCoefficients coefficients_;
  int known_ = -1;
};

}  // namespace tessera
