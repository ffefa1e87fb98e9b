// Directions towards the lights as one distribution over solid angle: choose a light, choose a point on it.
// Its density in a direction sums over every light in that direction, visible or hidden behind others
// (P. Shirley, "Ray Tracing: The Rest of Your Life", mixture of densities over hittables).
#pragma once

#include <optional>
#include <vector>

#include "renderer/integrator/emitter_tree.h"
#include "renderer/integrator/world.h"

namespace tessera {

// Immutable, shared by all threads. Covers the lights that rays can hit: emitting surfaces and lights at
// infinity. Lights that LightTable::Choose never chooses are not sampled here either.
class LightDirections {
 public:
  // `world` must outlive this and not move; its accelerator is not used.
  explicit LightDirections(const World& world);

  // Whether no light can be sampled from anywhere.
  bool empty() const { return empty_; }

  struct Drawn {
    Vec3 wi;  // unit
    // Per solid angle, of having chosen this light and this point: at most Pdf.
    float chosen_pdf = 0;
  };
  // Returns nullopt if the chosen point does not emit towards the reference point. u_choice in [0, 1).
  std::optional<Drawn> Sample(const ReferencePoint& reference, float u_choice, Point2 u,
                              const SampledWavelengths& wavelengths) const;

  // The density per solid angle with which Sample returns ray.d, which is of unit length. `ray` is the one
  // that will be traced: it starts at the reference point, offset from its surface. Integrates to less than 1
  // where Sample may return nullopt.
  float Pdf(const ReferencePoint& reference, const Ray& ray, const SampledWavelengths& wavelengths) const;

 private:
  // One emitting primitive.
  struct Emitter {
    uint32_t shape = 0, primitive = 0;
    int light = 0;
    uint32_t instance = Hit::kNoInstance;  // of a shape that moves
  };
  void AddShape(uint32_t instance, uint32_t shape, std::vector<Bounds3>* boxes);

  float EmitterPdf(const Emitter& emitter, const ReferencePoint& reference, const Ray& ray,
                   const SampledWavelengths& wavelengths) const;

  const World& world_;
  std::vector<Emitter> emitters_;  // their lights are consecutive
  EmitterTree tree_;
  bool empty_ = true;
};

}  // namespace tessera
