#include "renderer/color/spectrum.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderer/color/named_spectra.h"

namespace tessera {
namespace {

float EvaluateSigmoid(const SigmoidPolynomial& polynomial, float lambda) {
  const float x = (polynomial.c0 * lambda + polynomial.c1) * lambda + polynomial.c2;
  return 0.5f + x / (2 * std::sqrt(1 + x * x));
}

}  // namespace

Spectrum Spectrum::Constant(float value) {
  Spectrum spectrum;
  spectrum.scale_ = value;
  return spectrum;
}

Spectrum Spectrum::Sigmoid(SigmoidPolynomial polynomial, float scale) {
  Spectrum spectrum = Constant(scale);
  spectrum.has_sigmoid_ = true;
  spectrum.polynomial_ = polynomial;
  return spectrum;
}

Spectrum Spectrum::Table(std::shared_ptr<const DenseTable> table, float scale) {
  Spectrum spectrum = Constant(scale);
  spectrum.table_ = std::move(table);
  return spectrum;
}

Spectrum Spectrum::SigmoidTimesTable(SigmoidPolynomial polynomial, std::shared_ptr<const DenseTable> table,
                                     float scale) {
  Spectrum spectrum = Sigmoid(polynomial, scale);
  spectrum.table_ = std::move(table);
  return spectrum;
}

float Spectrum::At(float lambda) const {
  float value = scale_;
  if (has_sigmoid_) value *= EvaluateSigmoid(polynomial_, lambda);
  if (table_) {
    const long index = std::lround(lambda) - kLambdaMin;
    value *= index >= 0 && index < kLambdaCount ? (*table_)[static_cast<size_t>(index)] : 0;
  }
  return value;
}

float Spectrum::MaxValue() const {
  float largest = At(kLambdaMin);
  for (int lambda = kLambdaMin + 1; lambda <= kLambdaMax; ++lambda) {
    largest = std::max(largest, At(static_cast<float>(lambda)));
  }
  return largest;
}

Spectrum Spectrum::Scaled(float factor) const {
  Spectrum scaled = *this;
  scaled.scale_ *= factor;
  return scaled;
}

Spectrum Spectrum::WithoutColor() const {
  return has_sigmoid_ && table_ ? Table(table_) : *this;
}

float SpectrumToPhotometric(const Spectrum& spectrum) {
  double sum = 0;
  for (int i = 0; i < kLambdaCount; ++i) {
    const float y = CieY()[static_cast<size_t>(i)];
    sum += static_cast<double>(y) * static_cast<double>(spectrum.At(static_cast<float>(kLambdaMin + i)));
  }
  return static_cast<float>(sum);
}

}  // namespace tessera
