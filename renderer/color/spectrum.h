// Spectra as scenes describe them, in the few compact forms that can be evaluated at four wavelengths
// quickly.
#pragma once

#include <array>
#include <memory>

#include "renderer/color/sampled_spectrum.h"
#include "renderer/color/wavelengths.h"

namespace tessera {

// One value per whole nm from kLambdaMin to kLambdaMax.
using DenseTable = std::array<float, kLambdaCount>;

// The values of `table` at four wavelengths.
inline SampledSpectrum SampleTable(const DenseTable& table, const SampledWavelengths& wavelengths) {
  alignas(16) int index[4];
  _mm_store_si128(reinterpret_cast<__m128i*>(index), wavelengths.index);
  return {table[index[0]], table[index[1]], table[index[2]], table[index[3]]};
}

// s(c0 lambda^2 + c1 lambda + c2) with s(x) = 1/2 + x / (2 sqrt(1 + x^2)): a smooth spectrum in [0, 1] that
// stands for an RGB colour (Jakob and Hanika 2019). lambda in nm.
struct SigmoidPolynomial {
  float c0 = 0, c1 = 0, c2 = 0;

  SampledSpectrum Sample(const SampledWavelengths& wavelengths) const {
    const Float4 lambda = wavelengths.lambda;
    // Infinite coefficients (pure white or black) are never stored: the solver clamps them.
    const Float4 x = (Float4(c0) * lambda + Float4(c1)) * lambda + Float4(c2);
    return Float4(0.5f) + x / (Float4(2.0f) * Sqrt(Float4(1.0f) + x * x));
  }
};

// What an RGB triple stands for, which decides how it becomes a spectrum.
enum class SpectrumUse {
  kAlbedo,      // a reflectance: every component in [0, 1]
  kUnbounded,   // any coefficient: components at least 0
  kIlluminant,  // emitted light: the colour times the white of the colour space
};

// An immutable spectrum: scale x (1 or sigmoid) x (1 or table). Cheap to copy, safe to share between threads.
class Spectrum {
 public:
  // The same value at every wavelength.
  static Spectrum Constant(float value);
  static Spectrum Sigmoid(SigmoidPolynomial polynomial, float scale);
  static Spectrum Table(std::shared_ptr<const DenseTable> table, float scale = 1);
  static Spectrum SigmoidTimesTable(SigmoidPolynomial polynomial, std::shared_ptr<const DenseTable> table,
                                    float scale);

  SampledSpectrum Sample(const SampledWavelengths& wavelengths) const {
    SampledSpectrum value(scale_);
    if (has_sigmoid_) value *= polynomial_.Sample(wavelengths);
    if (table_) value *= SampleTable(*table_, wavelengths);
    return value;
  }
  // The value at a single wavelength (nm), to the nearest whole nm.
  float At(float lambda) const;
  // The largest value over the visible range.
  float MaxValue() const;
  bool IsConstant() const { return !has_sigmoid_ && !table_; }
  // A copy multiplied by `factor`.
  Spectrum Scaled(float factor) const;
  // For an illuminant given by RGB: its white alone (the table without the colour); else the spectrum itself.
  Spectrum WithoutColor() const;

 private:
  float scale_ = 0;
  bool has_sigmoid_ = false;
  SigmoidPolynomial polynomial_;
  std::shared_ptr<const DenseTable> table_;
};

// Integral of the product of the CIE 1931 y-bar curve and `spectrum` over the visible range, in whole-nm
// steps. Not divided by the integral of y-bar.
float SpectrumToPhotometric(const Spectrum& spectrum);

}  // namespace tessera
