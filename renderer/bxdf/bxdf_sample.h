// What BxDFs return: flags, values with densities, samples.
#pragma once

#include <cstdint>

#include "renderer/color/sampled_spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

// What a BxDF, or one sample of it, does to light.
enum class BxdfFlags : uint8_t {
  kNone = 0,
  kReflection = 1,
  kTransmission = 2,
  kDiffuse = 4,
  kGlossy = 8,
  kSpecular = 16,
};
constexpr BxdfFlags operator|(BxdfFlags a, BxdfFlags b) {
  return static_cast<BxdfFlags>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}
constexpr bool HasFlag(BxdfFlags flags, BxdfFlags flag) {
  return (static_cast<uint8_t>(flags) & static_cast<uint8_t>(flag)) != 0;
}

// A value and the density with which Sample would choose it.
struct BsdfEvaluation {
  SampledSpectrum f;  // per steradian, without the cosine
  float pdf = 0;      // per solid angle
};

struct BsdfSample {
  SampledSpectrum f;  // of a specular sample: divided by the cosine, as if the peak were 1
  Vec3 wi;            // unit; in the shading frame (Bxdf) or in rendering space (Bsdf)
  float pdf = 0;      // per solid angle; of a specular sample: the probability of the choice
  BxdfFlags flags = BxdfFlags::kNone;
  float eta = 1;  // relative index along the path if the sample is transmitted, else 1
  bool IsSpecular() const { return HasFlag(flags, BxdfFlags::kSpecular); }
  bool IsTransmission() const { return HasFlag(flags, BxdfFlags::kTransmission); }
};

// What travels along the path: light towards the camera, or importance towards a light. Refraction scales
// radiance by the square of the relative index, but not importance.
enum class TransportMode : uint8_t { kRadiance, kImportance };

// Which lobes of an interface to evaluate or sample.
enum class Lobes : uint8_t { kReflection = 1, kTransmission = 2, kBoth = 3 };
constexpr bool HasLobe(Lobes lobes, Lobes lobe) {
  return (static_cast<uint8_t>(lobes) & static_cast<uint8_t>(lobe)) != 0;
}

}  // namespace tessera
