// Properties of every kind: samples follow the density, reflection is reciprocal, no energy is created.
#include "renderer/bxdf/bxdf.h"

#include <gtest/gtest.h>

#include "renderer/bxdf/bsdf.h"
#include "tests/chi_square.h"
#include "tests/renderer/bxdf/bxdf_examples.h"

namespace tessera {
namespace {

const float kCosines[] = {0.98f, 0.5f, 0.08f, -0.6f};

bool IsWalked(const BxdfExample& example) {
  return example.name.starts_with("walked");
}

TEST(Bxdf, SamplesMatchTheirDensity) {
  TestRandom random(3);
  const std::vector<BxdfExample> examples = RoughExamples();
  const int test_count = static_cast<int>(examples.size() * std::size(kCosines));
  for (const BxdfExample& example : examples) {
    for (const float cos_o : kCosines) {
      const Vec3 wo = DirectionAt(cos_o, 0.4f);
      const auto sample = [&]() -> std::optional<Vec3> {
        const float uc = random.Next();
        const auto s = example.bxdf.Sample(wo, uc, random.Next2<Point2>());
        if (!s || s->IsSpecular()) return std::nullopt;
        return s->wi;
      };
      const ChiSquareResult r = ChiSquareSphere<Vec3>(
          sample, [&](Vec3 wi) { return example.bxdf.Evaluate(wo, wi).pdf; }, 16, 20,
          IsWalked(example) ? 4000 : 40000);
      EXPECT_TRUE(r.Passes(test_count)) << example.name << " at cos " << cos_o << ": " << r.text;
    }
  }
}

TEST(Bxdf, SamplesCarryTheValueAndDensityOfEvaluate) {
  TestRandom random(4);
  for (const BxdfExample& example : RoughExamples()) {
    for (int n = 0; n < 400; ++n) {
      const Vec3 wo = DirectionAt(kCosines[n % 4], 0.4f);
      const float uc = random.Next();
      const auto s = example.bxdf.Sample(wo, uc, random.Next2<Point2>());
      if (!s || s->IsSpecular()) continue;
      const BsdfEvaluation value = example.bxdf.Evaluate(wo, s->wi);
      EXPECT_NEAR(s->pdf, value.pdf, 1e-3f * value.pdf) << example.name;
      EXPECT_NEAR(Length(s->wi), 1, 1e-4) << example.name;
      EXPECT_EQ(s->IsTransmission(), !SameHemisphere(wo, s->wi)) << example.name;
      if (IsWalked(example)) continue;  // an estimate
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(s->f[i], value.f[i], 1e-3f * value.f[i]) << example.name;
    }
  }
}

TEST(Bxdf, ReflectionIsReciprocal) {
  TestRandom random(5);
  for (const BxdfExample& example : RoughExamples()) {
    if (IsWalked(example)) continue;                               // reciprocal on average only
    if (example.name.starts_with("measured")) continue;            // as far as the measurement is
    if (example.name.find("hair") != std::string::npos) continue;  // attenuation depends on wo alone
    for (int n = 0; n < 100; ++n) {
      const Vec3 a = SampleUniformSphere(random.Next2<Point2>());
      Vec3 b = SampleUniformSphere(random.Next2<Point2>());
      if (!SameHemisphere(a, b)) b.z = -b.z;
      const SampledSpectrum there = example.bxdf.Evaluate(a, b).f, back = example.bxdf.Evaluate(b, a).f;
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(there[i], back[i], 2e-3f * there[i] + 1e-6f) << example.name;
    }
  }
}

TEST(Bxdf, TransmittedRadianceIsReciprocalUpToTheSquareOfTheIndex) {
  TestRandom random(7);
  const float eta = 1.5f;
  const DielectricBxdf glass = TestInterface(0.4f, 0.4f, eta);
  int compared = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 above = SampleUniformHemisphere(random.Next2<Point2>());
    const Vec3 below = -SampleUniformHemisphere(random.Next2<Point2>());
    const float in = glass.Evaluate(above, below).f[0], out = glass.Evaluate(below, above).f[0];
    EXPECT_NEAR(in * eta * eta, out, 2e-3f * out + 1e-6f);
    // Importance travels against radiance.
    EXPECT_NEAR(glass.Evaluate(below, above, TransportMode::kImportance).f[0], in, 2e-3f * in + 1e-6f);
    compared += in > 1e-3f;
  }
  EXPECT_GT(compared, 50);
}

// Mean over samples of f |cos| / pdf: the albedo. For radiance carried through an interface the energy is f
// etap^2.
double Albedo(const Bxdf& bxdf, Vec3 wo, int sample_count, TestRandom& random) {
  double sum = 0;
  for (int n = 0; n < sample_count; ++n) {
    const float uc = random.Next();
    const auto s = bxdf.Sample(wo, uc, random.Next2<Point2>());
    if (s) sum += MaxElement(s->f) * AbsCosTheta(s->wi) / s->pdf * s->eta * s->eta;
  }
  return sum / sample_count;
}

TEST(Bxdf, NoEnergyIsCreated) {
  TestRandom random(8);
  std::vector<BxdfExample> examples = RoughExamples();
  for (const BxdfExample& example : SpecularExamples()) examples.push_back(example);
  for (const BxdfExample& example : examples) {
    for (const float cos_o : kCosines) {
      const double albedo = Albedo(example.bxdf, DirectionAt(cos_o, 1), 2000, random);
      EXPECT_LT(albedo, 1.02) << example.name << " at cos " << cos_o;
      EXPECT_GT(albedo, 0.05) << example.name << " at cos " << cos_o;
    }
  }
}

TEST(Bxdf, SmoothTransparentInterfacesKeepAllEnergy) {
  TestRandom random(9);
  for (const BxdfExample& example : SpecularExamples()) {
    if (example.name.starts_with("mirror")) continue;
    for (const float cos_o : kCosines) {
      EXPECT_NEAR(Albedo(example.bxdf, DirectionAt(cos_o, 1), 200, random), 1, 1e-4) << example.name;
    }
  }
}

TEST(Bxdf, SpecularKindsHaveNoDensity) {
  for (const BxdfExample& example : SpecularExamples()) {
    EXPECT_TRUE(HasFlag(example.bxdf.flags(), BxdfFlags::kSpecular)) << example.name;
    EXPECT_FALSE(HasFlag(example.bxdf.flags(), BxdfFlags::kGlossy | BxdfFlags::kDiffuse)) << example.name;
    const BsdfEvaluation value = example.bxdf.Evaluate(DirectionAt(0.5f, 0), DirectionAt(0.5f, kPi));
    EXPECT_EQ(value.pdf, 0) << example.name;
    EXPECT_FALSE(AnyNonZero(value.f)) << example.name;
  }
}

TEST(Bxdf, RoughGlassConvergesToSmoothGlass) {
  TestRandom random(10);
  const Vec3 wo = DirectionAt(0.7f, 0);
  for (const float side : {1.0f, -1.0f}) {
    const auto smooth = TestInterface(0, 0, 1.5f).Sample(wo * side, 0.99f, {0.3f, 0.4f});
    const auto rough = TestInterface(0.002f, 0.002f, 1.5f).Sample(wo * side, 0.99f, {0.3f, 0.4f});
    ASSERT_EQ(smooth.has_value(), rough.has_value());
    if (!smooth) continue;
    EXPECT_NEAR(Distance(smooth->wi, rough->wi), 0, 0.02);
    EXPECT_FLOAT_EQ(smooth->eta, rough->eta);
    const float a = smooth->f[0] * AbsCosTheta(smooth->wi) / smooth->pdf;
    const float b = rough->f[0] * AbsCosTheta(rough->wi) / rough->pdf;
    EXPECT_NEAR(a, b, 0.01f * a);
  }
}

TEST(Bsdf, OfRoughMetalHasALobeAroundTheMirrorDirection) {
  const Normal3 n = Normalize(Vec3{1, 2, 2});
  const Vec3 wo = Normalize(Vec3{3, 1, 0.5f});
  const SampledSpectrum eta(0.2f), k(3.0f);
  const Bsdf rough(n, {2, -1, 0}, ConductorBxdf({0.2f, 0.1f}, eta, k));
  const GlossyLobe lobe = rough.Lobe(wo);
  EXPECT_NEAR(Length(lobe.axis - (n * (2 * Dot(n, wo)) - wo)), 0, 1e-5f);
  EXPECT_FLOAT_EQ(lobe.alpha_squared, 0.2f * 0.1f);
  EXPECT_EQ(Bsdf(n, {2, -1, 0}, ConductorBxdf({0, 0}, eta, k)).Lobe(wo).alpha_squared, 0);
  EXPECT_EQ(Bsdf(n, {2, -1, 0}, DiffuseBxdf(SampledSpectrum(0.5f))).Lobe(wo).alpha_squared, 0);
}

TEST(Bsdf, IsEvaluatedInItsShadingFrame) {
  const Normal3 n = Normalize({1, 2, 3});
  const Bsdf bsdf(n, {1, 0, 0}, DiffuseBxdf(FourColors()));
  const auto sample = bsdf.Sample(n, 0.5f, {0.2f, 0.7f});
  ASSERT_TRUE(sample);
  EXPECT_GT(Dot(sample->wi, n), 0);
  EXPECT_NEAR(bsdf.Evaluate(n, sample->wi).pdf, Dot(sample->wi, n) * kInvPi, 1e-5);
  EXPECT_EQ(bsdf.Evaluate(n, -sample->wi).pdf, 0);
  EXPECT_FALSE(Bsdf().Sample({0, 0, 1}, 0.5f, {0.5f, 0.5f})) << "a default Bsdf absorbs";
}

}  // namespace
}  // namespace tessera
