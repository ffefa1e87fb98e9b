// Where a glossy surface scatters most of its light, roughly.
#pragma once

#include "renderer/math/vec.h"

namespace tessera {

// The reflection of one direction by microfacets. The density of scattered directions falls from its peak
// along the axis like the Trowbridge-Reitz distribution of half vectors.
struct GlossyLobe {
  Vec3 axis;                // unit, away from the surface
  float alpha_squared = 0;  // of the roughness alpha; 0: no lobe
};

}  // namespace tessera
