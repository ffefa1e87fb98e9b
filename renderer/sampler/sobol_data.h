// The published numbers that define the Sobol' sequence.
#pragma once

#include <cstdint>

namespace tessera {

constexpr int kSobolDimensions = 256;
// Primitive polynomials of dimensions 1 to 255, bit i the coefficient of z^i (dimension 0 is van der
// Corput's).
extern const uint16_t kSobolPolynomials[kSobolDimensions - 1];
// Starting values m_1 ... m_degree of each, one dimension after another.
extern const uint16_t kSobolStart[];

}  // namespace tessera
