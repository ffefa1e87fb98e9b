// The scenes of the probe unit. Whatever becomes possible to render belongs in here, which changes the
// digest.
#pragma once

#include <span>
#include <string>

namespace tessera {

// Settings before WorldBegin. Each variant has the same world.
struct ProbeVariant {
  const char* settings;
  const char* accelerator;
  // Includes lights that are points or directions, which only shadow rays find.
  bool has_lights_of_no_size;
  // Has all layers, light links and shapes that some rays do not meet.
  bool has_layers;
};
std::span<const ProbeVariant> ProbeVariants();

extern const char* const kProbeHead;            // film and camera; variants may name others
extern const char* const kProbeWorld;           // with WorldBegin
extern const char* const kProbeLightsOfNoSize;  // comes after it
extern const char* const kProbeVisibility;      // comes after both
extern const char* const kProbeMesh;            // "probe.ply"
extern const char* const kProbeLuminaire;       // "probe.ies"
extern const char* const kProbeLens;            // "probe.lens"
std::string ProbeImage();                       // "probe.pfm": square, in colour

}  // namespace tessera
