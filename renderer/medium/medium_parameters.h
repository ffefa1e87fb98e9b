// Parameters that several kinds of medium have.
#pragma once

#include <string_view>

#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"

namespace tessera {

constexpr float kCoefficientMax = 1e20f;  // per scene unit: products of two are finite

DenseTable Tabulate(const Spectrum& spectrum);

// Remembers an error at the parameter `name` if a coefficient times `factor` exceeds kCoefficientMax.
void CheckCoefficients(const DenseTable& table, float factor, std::string_view name, ParameterReader& reader);

// The largest sum of two coefficients over the wavelengths.
float LargestSum(const DenseTable& sigma_a, const DenseTable& sigma_s);

// A factor of the medium's coefficients or emission; 1 by default, not negative.
float ReadFactor(ParameterReader& reader, std::string_view name);

// `g`.
float ReadAsymmetry(ParameterReader& reader);

// `sigma_a` or `sigma_s`: 1 by default.
Spectrum ReadCoefficient(ParameterReader& reader, std::string_view name, FileSource& files);

// `Le`: emitted radiance, with luminance `factor` where it is given as a spectrum; the colour of an RGB
// triple keeps its magnitude, times the factor. Dark by default.
Spectrum ReadRadiance(ParameterReader& reader, FileSource& files, float factor);

}  // namespace tessera
