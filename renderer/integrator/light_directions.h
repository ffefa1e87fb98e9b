// Directions towards the lights as one distribution over solid angle: choose a light, choose a point on it.
// Its density at a direction sums over every light that the direction meets, seen or hidden behind others
// (P. Shirley, "Ray Tracing: The Rest of Your Life", mixture of densities over hittables).
#pragma once

#include <optional>
#include <vector>

#include "renderer/integrator/emitter_tree.h"
#include "renderer/integrator/world.h"

namespace tessera {

// Immutable, shared by all threads. Knows the lights that rays can hit: emitting surfaces and lights at
// infinity. What LightTable::Choose never takes is not sampled here either.
class LightDirections {
 public:
  // `world` must outlive this and not move; its accelerator is not used.
  explicit LightDirections(const World& world);

  // Whether no light can be sampled from anywhere.
  bool empty() const { return empty_; }

  struct Drawn {
    Vec3 wi;  // unit
    float chosen_pdf =
        0;  // per solid angle, of having chosen this light and this point: at most the whole Pdf
  };
  // Nothing if the chosen point does not emit towards the reference point. u_choice in [0, 1).
  std::optional<Drawn> Sample(const ReferencePoint& reference, float u_choice, Point2 u,
                              const SampledWavelengths& wavelengths) const;

  // The density per solid angle with which Sample gives ray.d, which is of unit length. `ray` starts at the
  // reference point, off its surface: the ray that is going to be traced. It integrates to less than 1 where
  // Sample may give nothing.
  float Pdf(const ReferencePoint& reference, const Ray& ray, const SampledWavelengths& wavelengths) const;

 private:
  // One emitting primitive.
  struct Emitter {
    uint32_t shape = 0, primitive = 0;
    int light = 0;
  };

  float EmitterPdf(const Emitter& emitter, const ReferencePoint& reference, const Ray& ray,
                   const SampledWavelengths& wavelengths) const;

  const World& world_;
  std::vector<Emitter> emitters_;  // their lights are consecutive
  EmitterTree tree_;
  bool empty_ = true;
};

}  // namespace tessera
