// Interpolation of tables by Catmull-Rom splines with nodes at any places, their integrals and inverses.
#pragma once

#include <array>
#include <optional>
#include <span>

namespace tessera {

// The value of a spline at a place is the sum of weights[i] times the value at node offset + i. Nodes before
// the first or after the last have weight 0.
struct SplineWeights {
  int offset = 0;
  std::array<float, 4> weights{};
};

// nodes: strictly rising, at least two. Returns nullopt outside them.
std::optional<SplineWeights> CatmullRomWeights(std::span<const float> nodes, float x);

// The integral of the spline through (nodes, values). before[i] becomes the integral up to node i.
float IntegrateCatmullRom(std::span<const float> nodes, std::span<const float> values,
                          std::span<float> before);

// The x where the rising spline through (nodes, values) has the value y; the first or last node beyond them.
float InvertCatmullRom(std::span<const float> nodes, std::span<const float> values, float y);

}  // namespace tessera
