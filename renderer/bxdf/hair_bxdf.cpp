#include "renderer/bxdf/hair_bxdf.h"

#include <algorithm>
#include <cmath>

#include "renderer/bxdf/fresnel.h"
#include "renderer/math/sampling.h"

namespace tessera {
namespace {

constexpr float kAbsorptionMax = 1e6f;   // black; keeps products finite
constexpr float kHairCosineMin = 1e-6f;  // keeps quotients by cosines finite
constexpr float kLogTwo = 0.693147181f;
// Longitudinal lobes narrower than this are computed by logarithms, as sinh overflows.
constexpr float kVarianceNarrow = 0.1f;

// NaN counts as `low`.
float ClampNumber(float x, float low, float high) {
  return std::min(high, std::max(low, x));
}

float PowerOf(float x, int n) {
  float result = 1;
  for (; n > 0; n >>= 1) {
    if (n & 1) result *= x;
    x *= x;
  }
  return result;
}

float SafeAsin(float x) {
  return std::asin(std::clamp(x, -1.0f, 1.0f));
}

// The modified Bessel function of the first kind and order 0, by its series. x in [0, kBesselSeriesMax].
constexpr float kBesselSeriesMax = 12;
float BesselI0(float x) {
  const float quarter_square = x * x / 4;
  float term = 1, sum = 1;
  for (int i = 1; i < 24 && term > 1e-8f * sum; ++i) {
    term *= quarter_square / static_cast<float>(i * i);
    sum += term;
  }
  return sum;
}
// Its logarithm, by the first terms of its asymptotic expansion where x is large.
float LogBesselI0(float x) {
  if (x <= kBesselSeriesMax) return std::log(BesselI0(x));
  return x - 0.5f * std::log(2 * kPi * x) + 1 / (8 * x);
}

float LogisticCdf(float x, float scale) {
  return 1 / (1 + std::exp(-x / scale));
}

// In [-pi, pi].
float WrapAngle(float phi) {
  return phi - 2 * kPi * std::round(phi * kInv2Pi);
}

}  // namespace

HairFibre::HairFibre(float eta, float beta_m, float beta_n, float alpha)
    : eta_(ClampNumber(eta, kEtaMin, kEtaMax)) {
  // Chiang et al., equations 7 and 8: perceptually uniform in beta.
  const float m = ClampNumber(beta_m, kBetaMin, kBetaMax);
  variance_ = Sqr(0.726f * m + 0.812f * m * m + 3.7f * PowerOf(m, 20));
  for (int p = 0; p < 3; ++p) {
    const float v = p == 0 ? variance_ : p == 1 ? 0.25f * variance_ : 4 * variance_;
    log_normalization_[static_cast<size_t>(p)] =
        v <= kVarianceNarrow ? kLogTwo - 1 / v - std::log(2 * v) : -std::log(2 * v * std::sinh(1 / v));
  }
  const float n = ClampNumber(beta_n, kBetaMin, kBetaMax);
  constexpr float kSqrtPiOver8 = 0.626657069f;
  scale_ = kSqrtPiOver8 * (0.265f * n + 1.194f * n * n + 5.372f * PowerOf(n, 22));
  logistic_total_ = LogisticCdf(kPi, scale_) - LogisticCdf(-kPi, scale_);
  sin_tilt_[0] = std::sin(Radians(ClampNumber(alpha, -90, 90)));
  cos_tilt_[0] = SafeSqrt(1 - Sqr(sin_tilt_[0]));
  for (size_t i = 1; i < 3; ++i) {
    sin_tilt_[i] = 2 * cos_tilt_[i - 1] * sin_tilt_[i - 1];
    cos_tilt_[i] = Sqr(cos_tilt_[i - 1]) - Sqr(sin_tilt_[i - 1]);
  }
}

HairBxdf::HairBxdf(const HairFibre& fibre, float h, SampledSpectrum sigma_a)
    : sigma_a_(Min(sigma_a, SampledSpectrum(kAbsorptionMax))),
      fibre_(fibre),
      h_(ClampNumber(h, -1, 1)),
      gamma_o_(SafeAsin(h_)) {}

SampledSpectrum HairBxdf::AbsorptionOfReflectance(SampledSpectrum reflectance, float beta_n) {
  const float n = ClampNumber(beta_n, HairFibre::kBetaMin, HairFibre::kBetaMax);
  const float n2 = n * n, n3 = n2 * n;
  const float divisor = 5.969f - 0.215f * n + 2.532f * n2 - 10.73f * n3 + 5.574f * n2 * n2 + 0.245f * n2 * n3;
  SampledSpectrum sigma_a;
  for (int i = 0; i < 4; ++i) {
    const float c = ClampNumber(reflectance[i], 0, 1);
    sigma_a.Set(i, c > 0 ? std::min(kAbsorptionMax, Sqr(std::log(c) / divisor)) : kAbsorptionMax);
  }
  return sigma_a;
}

HairBxdf::HairAngles::HairAngles(Vec3 w)
    : sin_theta(std::clamp(w.x, -1.0f, 1.0f)),
      cos_theta(SafeSqrt(1 - Sqr(sin_theta))),
      phi(std::atan2(w.z, w.y)) {}

HairBxdf::HairAngles::HairAngles(float sin_theta_, float phi_)
    : sin_theta(std::clamp(sin_theta_, -1.0f, 1.0f)), cos_theta(SafeSqrt(1 - Sqr(sin_theta))), phi(phi_) {}

HairBxdf::Lobes HairBxdf::LobesAt(Vec3 wo) const {
  Lobes lobes{HairAngles(wo), 0, {}, {}};
  const float eta = fibre_.eta_;
  const HairAngles& o = lobes.o;
  const float cos_theta_t = std::max(kHairCosineMin, SafeSqrt(1 - Sqr(o.sin_theta / eta)));
  // The index that a section across the hair seems to have (Marschner et al., appendix B).
  const float etap = SafeSqrt(eta * eta - Sqr(o.sin_theta)) / std::max(kHairCosineMin, o.cos_theta);
  const float sin_gamma_t = std::clamp(h_ / std::max(kHairCosineMin, etap), -1.0f, 1.0f);
  lobes.gamma_t = std::asin(sin_gamma_t);
  const float length = 2 * SafeSqrt(1 - Sqr(sin_gamma_t)) / cos_theta_t;
  const SampledSpectrum crossed = Exp(sigma_a_ * -length);

  const float fresnel = FrDielectric(o.cos_theta * SafeSqrt(1 - h_ * h_), eta);
  auto& a = lobes.attenuation;
  a[0] = SampledSpectrum(fresnel);
  a[1] = crossed * Sqr(1 - fresnel);
  a[2] = a[1] * crossed * fresnel;
  a[3] = SafeDiv(a[2] * crossed * fresnel, SampledSpectrum(1.0f) - crossed * fresnel);
  float sum = 0;
  for (const SampledSpectrum& lobe : a) sum += Average(lobe);
  for (size_t p = 0; p < kLobes; ++p)
    lobes.probability[p] = sum > 0 ? Average(a[p]) / sum : p == 0 ? 1.0f : 0;
  return lobes;
}

HairBxdf::HairAngles HairBxdf::Tilted(const HairAngles& o, int p) const {
  if (p > 2) return o;
  // By -2 alpha, alpha and 4 alpha.
  const size_t tilt = p == 0 ? 1 : p == 1 ? 0 : 2;
  const float sin_tilt = p == 0 ? -fibre_.sin_tilt_[tilt] : fibre_.sin_tilt_[tilt];
  const float cos_tilt = fibre_.cos_tilt_[tilt];
  HairAngles tilted = o;
  tilted.sin_theta = o.sin_theta * cos_tilt + o.cos_theta * sin_tilt;
  tilted.cos_theta = std::abs(o.cos_theta * cos_tilt - o.sin_theta * sin_tilt);
  return tilted;
}

float HairBxdf::Variance(int p) const {
  return p == 0 ? fibre_.variance_ : p == 1 ? 0.25f * fibre_.variance_ : 4 * fibre_.variance_;
}

// d'Eon et al., equation 7. Its integral with the cosine of theta_i over theta_i is 1.
float HairBxdf::Longitudinal(const HairAngles& i, const HairAngles& o, int p) const {
  const float v = Variance(p);
  const float a = i.cos_theta * o.cos_theta / v, b = i.sin_theta * o.sin_theta / v;
  return std::exp(LogBesselI0(a) - b + fibre_.log_normalization_[static_cast<size_t>(std::min(p, 2))]);
}

float HairBxdf::Turn(int p, float gamma_t) const {
  return static_cast<float>(2 * p) * gamma_t - 2 * gamma_o_ + static_cast<float>(p) * kPi;
}

float HairBxdf::Azimuthal(float phi, int p, float gamma_t) const {
  const float x = std::abs(WrapAngle(phi - Turn(p, gamma_t))) / fibre_.scale_;
  const float e = std::exp(-x);
  return e / (fibre_.scale_ * Sqr(1 + e) * fibre_.logistic_total_);
}

float HairBxdf::SampleAzimuth(float u) const {
  const float cdf = LogisticCdf(-kPi, fibre_.scale_) + u * fibre_.logistic_total_;
  return ClampNumber(-fibre_.scale_ * std::log(1 / cdf - 1), -kPi, kPi);
}

BsdfEvaluation HairBxdf::EvaluateLobes(const Lobes& lobes, const HairAngles& i) const {
  BsdfEvaluation result;
  const float phi = i.phi - lobes.o.phi;
  for (int p = 0; p < kLobes; ++p) {
    const auto index = static_cast<size_t>(p);
    const float azimuthal = p < kLobes - 1 ? Azimuthal(phi, p, lobes.gamma_t) : kInv2Pi;
    const float density = Longitudinal(i, Tilted(lobes.o, p), p) * azimuthal;
    result.f += lobes.attenuation[index] * density;
    result.pdf += lobes.probability[index] * density;
  }
  return result;
}

BsdfEvaluation HairBxdf::Evaluate(Vec3 wo, Vec3 wi) const {
  BsdfEvaluation result = EvaluateLobes(LobesAt(wo), HairAngles(wi));
  result.f /= std::max(kHairCosineMin, AbsCosTheta(wi));
  return result;
}

std::optional<BsdfSample> HairBxdf::Sample(Vec3 wo, float uc, Point2 u) const {
  const Lobes lobes = LobesAt(wo);
  int p = 0;
  while (p < kLobes - 1 && uc >= lobes.probability[static_cast<size_t>(p)]) {
    uc -= lobes.probability[static_cast<size_t>(p++)];
  }
  const float probability = lobes.probability[static_cast<size_t>(p)];
  if (!(probability > 0)) return std::nullopt;
  const float u_phi = std::min(uc / probability, kOneMinusEpsilon);

  const HairAngles o = Tilted(lobes.o, p);
  const float v = Variance(p);
  // d'Eon et al. 2013, "Importance Sampling for Physically-Based Hair Fiber Models", section 3.
  const float cosine =
      ClampNumber(1 + v * std::log(std::max(u.x, 1e-7f) + (1 - u.x) * std::exp(-2 / v)), -1, 1);
  const float sine = SafeSqrt(1 - Sqr(cosine)) * std::cos(2 * kPi * u.y);
  const float sin_theta_i = -cosine * o.sin_theta + sine * o.cos_theta;
  const float turn = p < kLobes - 1 ? Turn(p, lobes.gamma_t) + SampleAzimuth(u_phi) : 2 * kPi * u_phi;
  const HairAngles i(sin_theta_i, lobes.o.phi + turn);
  const Vec3 wi{i.sin_theta, i.cos_theta * std::cos(i.phi), i.cos_theta * std::sin(i.phi)};

  const BsdfEvaluation value = EvaluateLobes(lobes, i);
  if (!(value.pdf > 0)) return std::nullopt;
  const BxdfFlags side = SameHemisphere(wo, wi) ? BxdfFlags::kReflection : BxdfFlags::kTransmission;
  return BsdfSample{value.f / std::max(kHairCosineMin, AbsCosTheta(wi)), wi, value.pdf,
                    side | BxdfFlags::kGlossy, 1};
}

}  // namespace tessera
