#include "renderer/bssrdf/diffusion_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "renderer/bssrdf/catmull_rom.h"
#include "renderer/bxdf/fresnel.h"
#include "renderer/math/henyey_greenstein.h"

namespace tessera {
namespace {

constexpr int kBeamSamples = 100;  // of the integrals along the refracted beam

// The integrals of the Fresnel term with powers of the cosine, by quadrature.
float FresnelMoment(float eta, int power) {
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = (i + 0.5) / kSteps;
    sum += static_cast<double>(FrDielectric(static_cast<float>(cosine), eta)) * std::pow(cosine, power);
  }
  return static_cast<float>(sum / kSteps);
}

// Depths at which a beam is attenuated by equal parts, in mean free paths.
const std::array<float, kBeamSamples>& BeamDepths() {
  static const std::array<float, kBeamSamples> depths = [] {
    std::array<float, kBeamSamples> values{};
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = -std::log(1 - (static_cast<float>(i) + 0.5f) / kBeamSamples);
    return values;
  }();
  return depths;
}

struct Beam {
  float sigma_s, sigma_a, g, eta;
  float moment1, moment2;  // of the Fresnel term
};

// Habel et al., equations 5 to 12: a dipole at every depth of the beam.
float MultipleScattering(const Beam& b, float radius) {
  const float reduced_s = b.sigma_s * (1 - b.g), reduced_t = b.sigma_a + reduced_s;
  if (!(reduced_t > 0)) return 0;
  const float albedo = reduced_s / reduced_t;
  const float diffusion = (2 * b.sigma_a + reduced_s) / (3 * reduced_t * reduced_t);  // Grosjean's
  const float transport = SafeSqrt(b.sigma_a / diffusion);
  const float extrapolation = -2 * diffusion * (1 + 3 * b.moment2) / (1 - 2 * b.moment1);
  const float c_phi = 0.25f * (1 - 2 * b.moment1), c_e = 0.5f * (1 - 3 * b.moment2);
  float sum = 0;
  for (const float beam_depth : BeamDepths()) {
    const float real = beam_depth / reduced_t, mirrored = -real + 2 * extrapolation;
    const float d_real = std::sqrt(radius * radius + real * real);
    const float d_mirrored = std::sqrt(radius * radius + mirrored * mirrored);
    const float e_real = std::exp(-transport * d_real), e_mirrored = std::exp(-transport * d_mirrored);
    const float fluence = kInv4Pi / diffusion * (e_real / d_real - e_mirrored / d_mirrored);
    const auto flux = [&](float depth, float distance, float e) {
      return depth * (1 + transport * distance) * e / (distance * distance * distance);
    };
    const float irradiance = kInv4Pi * (flux(real, d_real, e_real) - flux(mirrored, d_mirrored, e_mirrored));
    const float kappa = 1 - std::exp(-2 * reduced_t * (d_real + real));  // empirical, for near sources
    sum += kappa * albedo * albedo * (fluence * c_phi + irradiance * c_e);
  }
  return sum / kBeamSamples;
}

// Of one event on a beam along the normal, at a radius: what does not depend on the albedo, for each depth of
// the beam. Albedos differ in sigma_s and sigma_a alone, whose sum is 1 up to rounding.
class SingleScatteringTerms {
 public:
  SingleScatteringTerms(const Beam& b, float sigma_t, float radius) : sigma_t_(sigma_t) {
    const float critical =
        radius * SafeSqrt(b.eta * b.eta - 1);  // depth above which light is reflected totally
    const std::array<float, kBeamSamples>& depths = BeamDepths();
    for (size_t i = 0; i < depths.size(); ++i) {
      const float depth = critical + depths[i] / sigma_t;
      const float distance = std::sqrt(radius * radius + depth * depth);
      const float cosine = depth / distance;
      terms_[i] = {std::exp(-sigma_t * (distance + critical)), distance * distance,
                   HenyeyGreenstein(cosine, b.g), 1 - FrDielectric(-cosine, b.eta), cosine};
    }
  }

  float sigma_t() const { return sigma_t_; }

  // Habel et al., equation 14.
  float Sum(float sigma_s) const {
    float sum = 0;
    for (const Term& term : terms_) {
      sum += sigma_s / sigma_t_ * term.attenuation / term.distance_squared * term.phase * term.transmitted *
             term.cosine;
    }
    return sum / kBeamSamples;
  }

 private:
  struct Term {
    float attenuation, distance_squared, phase, transmitted, cosine;
  };
  float sigma_t_;
  std::array<Term, kBeamSamples> terms_;
};

// Of all albedos.
void FillRadius(Beam beam, float radius, std::span<const float> albedos, size_t stride, float* profile) {
  std::optional<SingleScatteringTerms> single;
  for (size_t i = 0; i < albedos.size(); ++i) {
    beam.sigma_s = albedos[i];
    beam.sigma_a = 1 - albedos[i];
    const float sigma_t = beam.sigma_a + beam.sigma_s;
    if (!single || single->sigma_t() != sigma_t) single.emplace(beam, sigma_t, radius);
    float& value = profile[i * stride];
    value = 2 * kPi * radius * (single->Sum(beam.sigma_s) + MultipleScattering(beam, radius));
    // Without absorption or at extreme indices the integrals may fail in floats.
    if (!std::isfinite(value)) value = 0;
  }
}

}  // namespace

DiffusionProfile::DiffusionProfile(float g, float eta)
    : profile_(kAlbedos * kRadii), before_(kAlbedos * kRadii) {
  radii_[0] = 0;
  radii_[1] = 2.5e-3f;
  for (size_t i = 2; i < kRadii; ++i) radii_[i] = radii_[i - 1] * 1.2f;
  const Beam beam{0, 0, g, eta, FresnelMoment(eta, 1), FresnelMoment(eta, 2)};
  for (size_t i = 0; i < kAlbedos; ++i) {
    // Denser towards 1, where the effective albedo rises steeply.
    albedos_[i] = -std::expm1(-8 * static_cast<float>(i) / (kAlbedos - 1)) / -std::expm1(-8.0f);
  }
  for (size_t j = 0; j < kRadii; ++j) FillRadius(beam, radii_[j], albedos_, kRadii, &profile_[j]);
  for (size_t i = 0; i < kAlbedos; ++i) {
    effective_[i] = IntegrateCatmullRom(radii_, {profile_.data() + i * kRadii, kRadii},
                                        {before_.data() + i * kRadii, kRadii});
  }
}

DiffusionProfile::AlbedoPlace DiffusionProfile::PlaceOf(float albedo) const {
  const float within = albedo > 0 ? std::min(albedo, 1.0f) : 0;
  return CatmullRomWeights(albedos_, within).value_or(AlbedoPlace{});
}

float DiffusionProfile::Blend(const std::vector<float>& table, const AlbedoPlace& albedo, int radius_index) {
  float sum = 0;
  for (int i = 0; i < 4; ++i) {
    const float weight = albedo.weights[static_cast<size_t>(i)];
    const int index = (albedo.offset + i) * kRadii + radius_index;
    if (weight != 0) sum += weight * table[static_cast<size_t>(index)];
  }
  return sum;
}

float DiffusionProfile::Evaluate(const AlbedoPlace& albedo, float radius) const {
  const auto weights = CatmullRomWeights(radii_, radius);
  if (!weights) return 0;
  float sum = 0;
  for (int i = 0; i < 4; ++i) {
    const float weight = weights->weights[static_cast<size_t>(i)];
    if (weight != 0) sum += weight * Blend(profile_, albedo, weights->offset + i);
  }
  return radius > 0 ? std::max(0.0f, sum / (2 * kPi * radius)) : 0;
}

float DiffusionProfile::EffectiveAlbedo(const AlbedoPlace& albedo) const {
  float sum = 0;
  for (int i = 0; i < 4; ++i) {
    const float weight = albedo.weights[static_cast<size_t>(i)];
    const int index = albedo.offset + i;
    if (weight != 0) sum += weight * effective_[static_cast<size_t>(index)];
  }
  return sum;
}

float DiffusionProfile::AlbedoOf(float effective) const {
  return InvertCatmullRom(albedos_, effective_, effective);
}

std::optional<float> DiffusionProfile::SampleRadius(const AlbedoPlace& albedo, float u) const {
  const float total = Blend(before_, albedo, kRadii - 1);
  if (!(total > 0)) return std::nullopt;
  const float target = u * total;
  int low = 0, high = kRadii - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (Blend(before_, albedo, middle) <= target ? low : high) = middle;
  }
  // Within the interval by bisection of the integral of the spline's piece.
  std::array<float, kRadii> row;
  for (int j = std::max(0, low - 1); j <= std::min(kRadii - 1, high + 1); ++j) {
    row[static_cast<size_t>(j)] = Blend(profile_, albedo, j);
  }
  const auto i = static_cast<size_t>(low);
  const float width = radii_[i + 1] - radii_[i];
  const float f0 = row[i], f1 = row[i + 1];
  const float d0 = i > 0 ? width * (f1 - row[i - 1]) / (radii_[i + 1] - radii_[i - 1]) : f1 - f0;
  const float d1 = i + 2 < kRadii ? width * (row[i + 2] - f0) / (radii_[i + 2] - radii_[i]) : f1 - f0;
  const float rest = (target - Blend(before_, albedo, low)) / width;
  float t0 = 0, t1 = 1;
  for (int step = 0; step < 24; ++step) {
    const float t = (t0 + t1) / 2, t2 = t * t, t3 = t2 * t, t4 = t3 * t;
    const float integral = f0 * (t4 / 2 - t3 + t) + f1 * (t3 - t4 / 2) + d0 * (t4 / 4 - 2 * t3 / 3 + t2 / 2) +
                           d1 * (t4 / 4 - t3 / 3);
    (integral < rest ? t0 : t1) = t;
  }
  return radii_[i] + (t0 + t1) / 2 * width;
}

}  // namespace tessera
