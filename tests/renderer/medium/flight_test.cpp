#include "renderer/medium/flight.h"

#include <gtest/gtest.h>

#include <array>

#include "renderer/medium/homogeneous_medium.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

constexpr float kNothingElse = std::numeric_limits<float>::infinity();
constexpr int kFlights = 200000;

using Four = std::array<double, 4>;

Four ToFour(SampledSpectrum s) {
  return {s[0], s[1], s[2], s[3]};
}
// Wavelength i of the medium is at place (i + turn) % 4 of the result: each takes its turn as the first.
SampledSpectrum Turned(const Four& v, int turn) {
  float f[4];
  for (int i = 0; i < 4; ++i) f[(i + turn) % 4] = static_cast<float>(v[i]);
  return {f[0], f[1], f[2], f[3]};
}
void AddTurned(Four* sum, SampledSpectrum value, int turn) {
  for (int i = 0; i < 4; ++i) (*sum)[i] += static_cast<double>(value[(i + turn) % 4]) / kFlights;
}

struct Means {
  Four passed{}, scattered{}, emitted{}, passed_count{};
};

// The means of kFlights flights over `length`, with each wavelength deciding in turn. make(turn) is
// a medium ray.
template <typename MakeMedium>
Means FlyOften(const MakeMedium& make, float length) {
  Means means;
  TestRandom random(11);
  for (int i = 0; i < kFlights; ++i) {
    const int turn = i % 4;
    const Ray ray{{static_cast<float>(i), 0, 0}, {0, 0, 1}};
    FlightRandom numbers(ray, random.Next());
    PathWeights weights;
    SampledSpectrum emitted(0.0f);
    float t = 0;
    const FlightEnd end = Fly(make(turn), length, numbers, &weights, &emitted, &t);
    AddTurned(&means.emitted, emitted, turn);
    if (end == FlightEnd::kPassed) AddTurned(&means.passed, weights.Throughput(), turn);
    if (end == FlightEnd::kScattered) {
      EXPECT_LE(t, length);
      AddTurned(&means.scattered, weights.Throughput(), turn);
    }
  }
  return means;
}

template <typename MakeMedium>
Four MeanTransmittance(const MakeMedium& make, float length) {
  Four mean{};
  TestRandom random(12);
  for (int i = 0; i < kFlights; ++i) {
    const Ray ray{{static_cast<float>(i), 0, 0}, {0, 0, 1}};
    FlightRandom numbers(ray, random.Next());
    PathWeights weights;
    FlyShadow(make(i % 4), length, numbers, &weights);
    AddTurned(&mean, weights.beta / Average(weights.r_l), i % 4);
  }
  return mean;
}

void ExpectNear(const Four& found, const Four& expected, double tolerance, const char* what) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << what << ", wavelength " << i;
}

constexpr Four kSigmaA{0.1, 0.5, 0, 2}, kSigmaS{0.3, 1, 2.5, 0}, kEmission{0.2, 0, 0, 1};

struct Homogeneous {
  std::array<HomogeneousCoefficients, 4> turned;
  Homogeneous() {
    for (int i = 0; i < 4; ++i) turned[i] = {Turned(kSigmaA, i), Turned(kSigmaS, i), Turned(kEmission, i)};
  }
  HomogeneousRay operator()(int turn) const { return HomogeneousRay(turned[turn]); }
};

TEST(Flight, UniformMediaAgreeWithTheClosedForms) {
  const Homogeneous medium;
  for (const float length : {0.05f, 1.0f, 4.0f}) {
    const Means means = FlyOften(medium, length);
    Four passed, scattered, emitted;
    for (int i = 0; i < 4; ++i) {
      const double sigma_t = kSigmaA[i] + kSigmaS[i];
      passed[i] = std::exp(-sigma_t * length);
      scattered[i] = kSigmaS[i] / sigma_t * (1 - passed[i]);
      emitted[i] = kEmission[i] / sigma_t * (1 - passed[i]);
    }
    ExpectNear(means.passed, passed, 0.006, "passed");
    ExpectNear(means.scattered, scattered, 0.006, "scattered");
    ExpectNear(means.emitted, emitted, 1e-5, "emitted");
  }
}

TEST(Flight, MediaThatOnlyAbsorbHaveNoNoise) {
  const HomogeneousCoefficients tea{{0.1f, 0.5f, 0, 2}, {}, {}};
  for (const float u : {0.0f, 0.3f, 0.9999f}) {
    const Ray ray;
    FlightRandom numbers(ray, u);
    PathWeights weights;
    float t = 0;
    ASSERT_EQ(Fly(HomogeneousRay(tea), 1.5f, numbers, &weights, nullptr, &t), FlightEnd::kPassed);
    ExpectNear(ToFour(weights.Throughput()), {std::exp(-0.15), std::exp(-0.75), 1, std::exp(-3.0)}, 1e-6,
               "beta");
  }
}

TEST(Flight, InfiniteMediumReturnsOnlyItsEmission) {
  const Homogeneous medium;
  const Means means = FlyOften(medium, kNothingElse);
  ExpectNear(means.passed, {0, 0, 0, 0}, 0, "passed");
  ExpectNear(means.emitted, {0.2 / 0.4, 0, 0, 0.5}, 1e-5, "emitted");
  ExpectNear(means.scattered, {0.3 / 0.4, 1 / 1.5, 1, 0}, 0.01, "scattered");
}

TEST(Flight, TransmittanceOfShadowRaysIsExactWhereTheMediumIsUniform) {
  const Homogeneous medium;
  const Ray ray;
  FlightRandom numbers(ray, 0.5f);
  PathWeights weights;
  FlyShadow(medium(0), 2, numbers, &weights);
  ExpectNear(ToFour(weights.beta), {std::exp(-0.8), std::exp(-3.0), std::exp(-5.0), std::exp(-4.0)}, 1e-6,
             "T");
  EXPECT_EQ(ToFour(weights.r_l), (Four{1, 1, 1, 1}));
}

TEST(Flight, InfiniteThinMediaAreLeftBeforeFloatsOverflow) {
  const HomogeneousCoefficients thin{{}, SampledSpectrum(1e-30f), {}};
  const Ray ray;
  FlightRandom numbers(ray, 0.5f);
  PathWeights weights;
  float t = 0;
  EXPECT_EQ(Fly(HomogeneousRay(thin), kNothingElse, numbers, &weights, nullptr, &t), FlightEnd::kPassed);
  ExpectNear(ToFour(weights.Throughput()), {1, 1, 1, 1}, 1e-6, "beta");
}

// Both techniques must agree on the densities of a path that both can make, or their weights do not add up
// to 1.
TEST(Flight, PathsAndShadowRaysAgreeOnTheRatioOfTheirDensities) {
  const Homogeneous medium;
  const Ray ray;
  for (int turn = 0; turn < 4; ++turn) {
    FlightRandom numbers(ray, 0);
    // The largest number gives the longest flight, which passes.
    FlightRandom late(ray, 0x1.fffffep-1f);
    PathWeights shadow, path;
    float t = 0;
    FlyShadow(medium(turn), 0.7f, numbers, &shadow);
    ASSERT_EQ(Fly(medium(turn), 0.7f, late, &path, nullptr, &t), FlightEnd::kPassed);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(shadow.r_u[i] / shadow.r_l[i], path.r_u[i] / path.r_l[i], 1e-6) << turn << i;
    }
  }
}

// A medium of two stretches, [0, 1) and [1, 3), whose density rises from 0.2 to 1 along each, under loose
// bounds. The first has a share of absorption in common.
class RisingMedium {
 public:
  explicit RisingMedium(int turn) : turn_(turn) {}

  static double Density(double t) { return t < 1 ? 0.2 + 0.8 * t : 0.2 + 0.4 * (t - 1); }
  static constexpr Four kCommon{0.3, 0, 0.1, 0.2};

  bool Next(MajorantSegment* segment) {
    if (stretch_ == 2) return false;
    *segment = {};
    segment->t_end = stretch_ == 0 ? 1 : 3;
    segment->sigma_maj = (Turned(kSigmaA, turn_) + Turned(kSigmaS, turn_)) * 1.3f + SampledSpectrum(0.1f);
    if (stretch_ == 0) segment->sigma_a = Turned(kCommon, turn_);
    ++stretch_;
    return true;
  }
  MediumPoint At(float t) const {
    const float density = static_cast<float>(Density(static_cast<double>(t)));
    return {Turned(kSigmaA, turn_) * density, Turned(kSigmaS, turn_) * density,
            Turned(kEmission, turn_) * density};
  }

 private:
  int turn_, stretch_ = 0;
};

struct RisingMeans {
  Four passed, scattered{}, emitted{};
};

// By numerical integration.
RisingMeans IntegrateRising(double length) {
  RisingMeans means;
  constexpr int kSteps = 20000;
  Four depth{};
  const double dt = length / kSteps;
  for (int step = 0; step < kSteps; ++step) {
    const double t = (step + 0.5) * dt, density = t < 3 ? RisingMedium::Density(t) : 0;
    for (int i = 0; i < 4; ++i) {
      const double sigma_t = (kSigmaA[i] + kSigmaS[i]) * density + (t < 1 ? RisingMedium::kCommon[i] : 0);
      const double transmittance = std::exp(-(depth[i] + 0.5 * sigma_t * dt));
      means.scattered[i] += transmittance * kSigmaS[i] * density * dt;
      means.emitted[i] += transmittance * kEmission[i] * density * dt;
      depth[i] += sigma_t * dt;
    }
  }
  for (int i = 0; i < 4; ++i) means.passed[i] = std::exp(-depth[i]);
  return means;
}

TEST(Flight, NullCollisionsKeepTheMeansOfVaryingMedia) {
  for (const float length : {0.6f, 2.0f, 5.0f}) {
    const RisingMeans expected = IntegrateRising(static_cast<double>(length));
    const Means means = FlyOften([](int turn) { return RisingMedium(turn); }, length);
    ExpectNear(means.passed, expected.passed, 0.008, "passed");
    ExpectNear(means.scattered, expected.scattered, 0.008, "scattered");
    ExpectNear(means.emitted, expected.emitted, 0.008, "emitted");
  }
}

TEST(Flight, RatioTrackingEstimatesTheTransmittanceOfVaryingMedia) {
  for (const float length : {0.6f, 2.0f, 5.0f}) {
    const RisingMeans expected = IntegrateRising(static_cast<double>(length));
    const Four mean = MeanTransmittance([](int turn) { return RisingMedium(turn); }, length);
    ExpectNear(mean, expected.passed, 0.006, "transmittance");
  }
}

TEST(Flight, IntegralOfTheExponentialIsExactForSmallAndLargeDepths) {
  for (const float t : {1e-6f, 0.3f, 5.0f, 3e38f}) {
    const SampledSpectrum found = IntegralOfExp({0, 1e-5f, 0.033f, 40}, t);
    const Four sigma{0, static_cast<double>(1e-5f), static_cast<double>(0.033f), 40};
    for (int i = 0; i < 4; ++i) {
      const double length = static_cast<double>(t);
      const double expected = sigma[i] == 0 ? length : -std::expm1(-sigma[i] * length) / sigma[i];
      EXPECT_NEAR(static_cast<double>(found[i]) / expected, 1, 1e-5) << sigma[i] << " over " << t;
    }
  }
}

}  // namespace
}  // namespace tessera
