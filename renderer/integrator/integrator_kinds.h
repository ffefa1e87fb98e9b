// The integrators that scenes and options may name. All converge to the same picture where each is valid;
// they differ in noise and speed.
#pragma once

#include "renderer/description/kind_table.h"

namespace tessera {

enum class IntegratorKind {
  kPath,           // light and BSDF sampling at every vertex, weighted against each other; roulette
  kVolPath,        // the same, in participating media too
  kMixture,        // one ray per vertex, drawn from BSDF and lights together (mixture_integrator.h)
  kSimplePath,     // one technique at a time (simple_path_integrator.h)
  kSimpleVolPath,  // BSDF sampling, emission where rays hit it, in media too
  kRandomWalk,     // uniform directions, emission where rays hit it
};

struct IntegratorTraits {
  IntegratorKind kind = IntegratorKind::kPath;
  bool follows_media = false;
  // Traces shadow rays, and so finds lights that no ray can hit. `simplepath` has a switch for it.
  bool has_shadow_rays = false;
  // Scatters light in "subsurface" materials, which are clear glass for the others.
  bool has_subsurface = false;
  // Draws rays from the lights' own densities (light_directions.h), so every light must be one that rays hit.
  bool draws_rays_to_lights = false;
};

// A mapped integrator has the traits of the one that renders instead.
KindTable<IntegratorTraits> Integrators();

}  // namespace tessera
