// Sigmoid polynomials of a grid of RGB albedos, for lookup by trilinear interpolation. Laid out as by Jakob
// and Hanika (2019): which component is the largest (3), its value (64, denser near 0 and 1), the ratios of
// the two others to it (64 each). pbrt's tables have the same grid, so the error of interpolation is the
// same.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "renderer/color/sigmoid_solver.h"
#include "renderer/color/spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

constexpr size_t kRgbTableResolution = 64;
// Number of coefficients. One more float must be readable after them.
constexpr size_t kRgbTableFloats = 3 * kRgbTableResolution * kRgbTableResolution * kRgbTableResolution * 3;

// Solves for every grid point, which takes seconds. Includes the extra float that lookups may read.
std::vector<float> BuildRgbTable(const SigmoidSolver& solver);
// The polynomial of `rgb`, components in [0, 1] and not all equal.
SigmoidPolynomial LookUpRgbTable(const float* table, Vec3 rgb);

}  // namespace tessera
