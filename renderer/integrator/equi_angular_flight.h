// Light that a medium scatters where a ray passes a light.
#pragma once

#include <optional>

#include "renderer/light/light.h"
#include "renderer/math/ray.h"
#include "renderer/medium/homogeneous_medium.h"

namespace tessera {

// A flight through a homogeneous medium on which a path looks for light at one distance of its own, beside
// the collision from which it goes on. The density of collisions does not depend on lights: where a ray
// passes close to a small light, or where collisions are rare, they find what scatters most of the light too
// seldom. A light is chosen for the ray, and a distance that is dense near this light (EquiAngular). Light
// sampling after a collision, and scattered rays that hit the light, find the same paths: multiple importance
// sampling weights the three.
class EquiAngularFlight {
 public:
  // Where light is looked for.
  struct Place {
    int light = 0;               // index into the LightTable
    float t = 0;                 // along the ray
    float density = 0;           // of both: per length
    float relative_density = 0;  // divided by the density of a collision at t
  };

  // At first, and after Clear, collisions alone find light.
  void Clear() { lights_ = nullptr; }
  // The direction of the ray is of unit length. `lights` must outlive the flight. Written member by member:
  // the copy of a ray waits for the stores of its parts.
  void Start(const LightTable& lights, const HomogeneousCoefficients& medium, const Ray& ray) {
    lights_ = &lights;
    sigma_a_ = medium.sigma_a;
    sigma_s_ = medium.sigma_s;
    extinction_ = Average(medium.sigma_a + medium.sigma_s);
    ray_.o = ray.o;
    ray_.d = ray.d;
  }

  // u_light and u_distance in [0, 1). Returns nullopt if light is not to be looked for.
  std::optional<Place> Sample(float u_light, float u_distance) const;
  // Place::relative_density of a light and a distance.
  float RelativeDensity(int light, float t) const {
    return lights_ == nullptr ? 0 : RelativeDensityOfStarted(light, t);
  }
  // Becomes equal to `other`. Cheap if that is as after Clear.
  void Follow(const EquiAngularFlight& other) {
    if (other.lights_ == nullptr) {
      Clear();
    } else {
      *this = other;
    }
  }

  // The density of a collision at t, per length, if each of the wavelengths decided.
  SampledSpectrum CollisionDensities(float t) const { return sigma_s_ * Exp(sigma_s_ * -t); }
  // What absorption lets through up to t.
  SampledSpectrum Unabsorbed(float t) const { return Exp(sigma_a_ * -t); }

 private:
  float RelativeDensityOfStarted(int light, float t) const;
  // Whether light is looked for on a ray that comes this near to a light. Where the light is farther away
  // than a mean free path, the density of collisions is as good.
  bool IsNear(float distance) const { return extinction_ * distance < 1; }

  const LightTable* lights_ = nullptr;  // null: after Clear
  SampledSpectrum sigma_a_, sigma_s_;   // per scene unit
  float extinction_ = 0;                // the mean of their sum
  Ray ray_;
};

}  // namespace tessera
