// Where a light or a group of lights is, and in which directions it emits (Conty Estevez and Kulla 2018,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting"; Pharr, Jakob, Humphreys 2023,
// section 12.6.3).
#pragma once

#include <limits>

#include "renderer/math/bounds.h"
#include "renderer/shape/shape_sampling.h"

namespace tessera {

// Normals of the emitters lie within theta_o of the axis; each emits within theta_e, at most 90 degrees, of
// its normal, and the less the farther from it.
struct LightBounds {
  Bounds3 box;
  Vec3 axis{0, 0, 1};
  float cos_theta_o = 1, cos_theta_e = 1;
  // The irradiance at distance 1 on the axis if all lights were at one point.
  float strength = 0;
  bool two_sided = false;
  // If all emitters face the same way (theta_o = 0, one-sided): no light reaches points p with Dot(axis, p)
  // below this.
  float plane_min = -std::numeric_limits<float>::infinity();

  // Makes them those of lights that may emit in any direction.
  void AddAllDirections();
};

// A narrow cone that contains both.
NormalCone Union(const NormalCone& a, const NormalCone& b);
LightBounds Union(const LightBounds& a, const LightBounds& b);

// The cost of these lights as one node of a tree, without the factor for the split axis: strength times the
// measure of their directions times the square of their size.
float ClusterCost(const LightBounds& bounds);

}  // namespace tessera
