#include "renderer/color/sigmoid_solver.h"

#include <algorithm>
#include <cmath>

#include "renderer/color/named_spectra.h"

namespace tessera {
namespace {

// Largest coefficient: a spectrum that is this close to 1 (6e-6) looks no different. The same bound as in the
// tables of Jakob and Hanika, which matters for colours that no reflectance has.
constexpr double kCoefficientMax = 200;
// Largest magnitude of a negative one: keeps black finite.
constexpr double kMagnitudeMax = 5000;
// Squared distance in L*a*b* at which a colour is met: a two-thousandth of what an eye can tell.
constexpr double kCostMet = 1e-7;
constexpr double kProgressMin = 1e-6;  // relative decrease of the cost below which the search ends
constexpr int kStepsMax = 60;
constexpr double kDampingFirst = 1e-4, kDampingMin = 1e-12, kDampingMax = 1e8;

using Vector = std::array<double, 3>;

// Cube root of t in (0.008, 2] to the last bits: Halley's iteration from a line that is right at both ends.
double CubeRoot(double t) {
  double root = 0.2 + 0.85 * t;
  for (int i = 0; i < 4; ++i) {
    const double cube = root * root * root;
    root = root * (cube + 2 * t) / (2 * cube + t);
  }
  return root;
}

struct Lightness {
  double value, slope;
};

// f of CIE L*a*b* and its derivative.
Lightness LabFunction(double t) {
  constexpr double kDelta = 6.0 / 29.0;
  if (t <= kDelta * kDelta * kDelta) {
    constexpr double kSlope = 1 / (3 * kDelta * kDelta);
    return {t * kSlope + 4.0 / 29.0, kSlope};
  }
  const double root = CubeRoot(t);
  return {root, 1 / (3 * root * root)};
}

Vector ToLab(const Vector& f) {
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

void Bound(SigmoidCoefficients& c) {
  const double largest = std::max(c[0], std::max(c[1], c[2]));
  const double magnitude = std::max(std::abs(c[0]), std::max(std::abs(c[1]), std::abs(c[2])));
  const double scale = std::min(largest > kCoefficientMax ? kCoefficientMax / largest : 1.0,
                                magnitude > kMagnitudeMax ? kMagnitudeMax / magnitude : 1.0);
  for (double& value : c) value *= scale;
}

double Sum(__m256d v) {
  alignas(32) double lane[4];
  _mm256_store_pd(lane, v);
  return (lane[0] + lane[1]) + (lane[2] + lane[3]);
}

// The state of the search: where it is, how far from the target, and how that changes.
struct Fit {
  SigmoidCoefficients at;
  Vector residual;
  Matrix3d jacobian;  // of the L*a*b* colour
  double cost;
};

// The step of Levenberg and Marquardt: solves (J'J + damping diag(J'J)) step = J' residual.
Vector DampedStep(const Fit& fit, double damping) {
  Matrix3d normal{};
  Vector right{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      for (size_t k = 0; k < 3; ++k) normal[i][j] += fit.jacobian[k][i] * fit.jacobian[k][j];
    }
    for (size_t k = 0; k < 3; ++k) right[i] += fit.jacobian[k][i] * fit.residual[k];
  }
  for (size_t i = 0; i < 3; ++i) normal[i][i] += damping * normal[i][i] + 1e-18;
  const Matrix3d inverse = Inverse(normal);
  Vector step{};
  for (size_t i = 0; i < 3; ++i) {
    step[i] = inverse[i][0] * right[0] + inverse[i][1] * right[1] + inverse[i][2] * right[2];
  }
  return step;
}

}  // namespace

struct SigmoidSolver::Response {
  Vector xyz{};            // relative to white
  Matrix3d derivatives{};  // of each of xyz by each coefficient
};

SigmoidSolver::SigmoidSolver(const RgbPrimaries& primaries) {
  const DenseTable& white = *NamedSpectrum(primaries.white);
  const DenseTable* const matching[] = {&CieX(), &CieY(), &CieZ()};
  const Vector xyz = XyzOf(white);
  constexpr double kNorm = static_cast<double>(kCieYIntegral);
  for (size_t i = 0; i < kLambdaCount; ++i) {
    t_[i] = static_cast<double>(i) / (kLambdaMax - kLambdaMin);
    for (size_t j = 0; j < 3; ++j) {
      weight_[j][i] =
          static_cast<double>((*matching[j])[i]) * static_cast<double>(white[i]) / (xyz[j] * kNorm);
    }
  }
  relative_xyz_from_rgb_ = XyzFromRgb(primaries);
  for (size_t i = 0; i < 3; ++i) {
    for (double& entry : relative_xyz_from_rgb_[i]) entry /= xyz[i];
  }
}

SigmoidSolver::Response SigmoidSolver::Evaluate(const SigmoidCoefficients& c) const {
  __m256d value[3], derivative[3][3];
  for (size_t j = 0; j < 3; ++j) {
    value[j] = _mm256_setzero_pd();
    for (size_t i = 0; i < 3; ++i) derivative[j][i] = _mm256_setzero_pd();
  }
  const __m256d half = _mm256_set1_pd(0.5), one = _mm256_set1_pd(1);
  const __m256d c0 = _mm256_set1_pd(c[0]), c1 = _mm256_set1_pd(c[1]), c2 = _mm256_set1_pd(c[2]);
  for (size_t i = 0; i < kPaddedCount; i += kLanes) {
    const __m256d t = _mm256_load_pd(&t_[i]);
    const __m256d x = _mm256_add_pd(_mm256_mul_pd(_mm256_add_pd(_mm256_mul_pd(c0, t), c1), t), c2);
    const __m256d r = _mm256_div_pd(one, _mm256_sqrt_pd(_mm256_add_pd(one, _mm256_mul_pd(x, x))));
    const __m256d sigmoid = _mm256_add_pd(half, _mm256_mul_pd(half, _mm256_mul_pd(x, r)));
    const __m256d slope = _mm256_mul_pd(half, _mm256_mul_pd(r, _mm256_mul_pd(r, r)));
    for (size_t j = 0; j < 3; ++j) {
      const __m256d weight = _mm256_load_pd(&weight_[j][i]);
      value[j] = _mm256_add_pd(value[j], _mm256_mul_pd(weight, sigmoid));
      const __m256d by_c2 = _mm256_mul_pd(weight, slope), by_c1 = _mm256_mul_pd(by_c2, t);
      derivative[j][2] = _mm256_add_pd(derivative[j][2], by_c2);
      derivative[j][1] = _mm256_add_pd(derivative[j][1], by_c1);
      derivative[j][0] = _mm256_add_pd(derivative[j][0], _mm256_mul_pd(by_c1, t));
    }
  }
  Response response;
  for (size_t j = 0; j < 3; ++j) {
    response.xyz[j] = Sum(value[j]);
    for (size_t i = 0; i < 3; ++i) response.derivatives[j][i] = Sum(derivative[j][i]);
  }
  return response;
}

SigmoidCoefficients SigmoidSolver::Solve(const std::array<double, 3>& rgb, SigmoidCoefficients start) const {
  Vector target_f{};
  for (size_t i = 0; i < 3; ++i) {
    const auto& row = relative_xyz_from_rgb_[i];
    target_f[i] = LabFunction(row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]).value;
  }
  const Vector target = ToLab(target_f);
  const auto fit_at = [&](const SigmoidCoefficients& at) {
    Fit fit{.at = at, .residual = {}, .jacobian = {}, .cost = 0};
    const Response response = Evaluate(at);
    Vector f{};
    Matrix3d df{};
    for (size_t j = 0; j < 3; ++j) {
      const Lightness lightness = LabFunction(response.xyz[j]);
      f[j] = lightness.value;
      for (size_t i = 0; i < 3; ++i) df[j][i] = lightness.slope * response.derivatives[j][i];
    }
    const Vector lab = ToLab(f);
    for (size_t i = 0; i < 3; ++i) {
      fit.residual[i] = target[i] - lab[i];
      fit.cost += fit.residual[i] * fit.residual[i];
      fit.jacobian[0][i] = 116 * df[1][i];
      fit.jacobian[1][i] = 500 * (df[0][i] - df[1][i]);
      fit.jacobian[2][i] = 200 * (df[1][i] - df[2][i]);
    }
    return fit;
  };
  Bound(start);
  Fit fit = fit_at(start);
  double damping = kDampingFirst;
  for (int step_count = 0; step_count < kStepsMax && fit.cost > kCostMet && damping < kDampingMax;
       ++step_count) {
    const Vector step = DampedStep(fit, damping);
    SigmoidCoefficients next = fit.at;
    for (size_t i = 0; i < 3; ++i) next[i] += step[i];
    Bound(next);
    const Fit trial = fit_at(next);
    if (!(trial.cost < fit.cost)) {
      damping *= 10;
      continue;
    }
    const bool stuck = fit.cost - trial.cost < kProgressMin * fit.cost;
    fit = trial;
    damping = std::max(kDampingMin, damping * 0.1);
    if (stuck) break;
  }
  return fit.at;
}

SigmoidPolynomial SigmoidSolver::ToPolynomial(const SigmoidCoefficients& c) {
  constexpr double kScale = 1.0 / (kLambdaMax - kLambdaMin), kOffset = kLambdaMin * kScale;
  const double c0 = c[0] * kScale * kScale;
  const double c1 = (c[1] - 2 * c[0] * kOffset) * kScale;
  const double c2 = (c[0] * kOffset - c[1]) * kOffset + c[2];
  return {static_cast<float>(c0), static_cast<float>(c1), static_cast<float>(c2)};
}

SigmoidPolynomial SigmoidSolver::Grey(float value) {
  // Floats beyond +-1e4 give 0 and 1 exactly.
  constexpr float kNearlyInfinite = 1e4f;
  const float x = (value - 0.5f) / std::sqrt(value * (1 - value));
  return {0, 0, std::clamp(x, -kNearlyInfinite, kNearlyInfinite)};
}

}  // namespace tessera
