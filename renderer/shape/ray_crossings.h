// Every point where a ray meets one primitive, not only the nearest: what a density over directions needs.
#pragma once

#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// No primitive has more: a line meets a quadric or a bilinear patch at most twice.
constexpr int kCrossingsMax = 2;

// The hits of primitive `primitive` of `shape` (not instanced) with t in (0, ray.t_max], in ascending order.
// Returns how many there are. Hit::shape is `shape_index`. Alpha is not looked at.
int RayCrossings(const Shape& shape, uint32_t shape_index, uint32_t primitive, const Ray& ray,
                 Hit hits[kCrossingsMax]);

}  // namespace tessera
