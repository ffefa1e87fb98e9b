// A metal under a coat against a plain simulation of the light between the two.
#include "renderer/bxdf/layered_conductor_bxdf.h"

#include <gtest/gtest.h>

#include "renderer/bxdf/conductor_bxdf.h"
#include "renderer/math/henyey_greenstein.h"
#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/bxdf/bxdf_means.h"

namespace tessera {
namespace {

struct CoatedMetal {
  float alpha_coat, alpha_metal;
  CoatLayer layer;
  float cos_o;
  std::string Name() const {
    return "coat " + std::to_string(alpha_coat) + " metal " + std::to_string(alpha_metal) + " thickness " +
           std::to_string(layer.thickness) + " albedo " + std::to_string(layer.albedo[0]) + " cosine " +
           std::to_string(cos_o);
  }
};

CoatLayer DeepLayer(float thickness, float albedo, float g) {
  CoatLayer layer = TestLayer(thickness, albedo, g);
  layer.depth_max = 200;
  return layer;
}

std::vector<CoatedMetal> CoatedMetals() {
  std::vector<CoatedMetal> all;
  for (const CoatLayer& layer : {DeepLayer(0.05f, 0, 0), DeepLayer(0.6f, 0.9f, 0.5f)}) {
    for (const float alpha_coat : {0.0f, 0.1f, 0.4f}) {
      for (const float alpha_metal : {0.0f, 0.15f, 0.6f}) {
        for (const float cos_o : {0.9f, 0.35f}) all.push_back({alpha_coat, alpha_metal, layer, cos_o});
      }
    }
  }
  return all;
}

constexpr float kMetalEta = 0.9f, kMetalK = 2.4f;  // relative to the coat

LayeredConductorBxdf BxdfOf(const CoatedMetal& c) {
  return {TestInterface(c.alpha_coat, c.alpha_coat, 1.5f),
          MicrofacetDistribution(c.alpha_metal, c.alpha_metal), SampledSpectrum(kMetalEta),
          SampledSpectrum(kMetalK), c.layer};
}

// Light that leaves the surface: its weight and direction; weight 0 if it is absorbed.
struct Leaving {
  float weight = 0;
  Vec3 w;
};

// One photon, followed from interface to interface without any next-event estimation.
Leaving SimulatePhoton(const CoatedMetal& c, TestRandom& random) {
  const DielectricBxdf coat = TestInterface(c.alpha_coat, c.alpha_coat, 1.5f);
  const ConductorBxdf metal(MicrofacetDistribution(c.alpha_metal, c.alpha_metal), SampledSpectrum(kMetalEta),
                            SampledSpectrum(kMetalK));
  const Vec3 wo = DirectionAt(c.cos_o, 0);
  float weight = 1, z = c.layer.thickness;
  Vec3 w = -wo;
  for (int event = 0; event < 400; ++event) {
    const bool at_coat = event == 0 || w.z > 0;
    if (event > 0) {
      const float step = -std::log(1 - random.Next()) * std::abs(w.z);
      const float next = w.z > 0 ? z + step : z - step;
      if (next > 0 && next < c.layer.thickness) {
        z = next;
        weight *= c.layer.albedo[0];
        if (weight == 0) return {};
        const Point2 u = random.Next2<Point2>();
        w = DirectionAround(w, SampleHenyeyGreensteinDeflection(c.layer.g, u.x), u.y);
        continue;
      }
      z = w.z > 0 ? c.layer.thickness : 0;
    }
    const float uc = random.Next();
    const Point2 u = random.Next2<Point2>();
    const auto s = at_coat ? coat.Sample(-w, uc, u) : metal.Sample(-w, uc, u);
    if (!s) return {};
    weight *= s->f[0] * AbsCosTheta(s->wi) / s->pdf;
    w = s->wi;
    if (at_coat && w.z > 0) return {weight, w};
  }
  return {};
}

// Light of the uniform sky that the BxDF reflects, weighed by a function of its direction.
template <typename Weigh>
Mean Reflected(const CoatedMetal& c, int count, const Weigh& weigh) {
  const LayeredConductorBxdf bxdf = BxdfOf(c);
  TestRandom random(5);
  return MeanOf(count, [&](int) {
    const float uc = random.Next();
    const auto s = bxdf.Sample(DirectionAt(c.cos_o, 0), uc, random.Next2<Point2>());
    return s ? s->f[0] * AbsCosTheta(s->wi) / s->pdf * weigh(s->wi) : 0.0f;
  });
}

TEST(LayeredConductor, ReflectsWhatPhotonsDo) {
  const auto all = [](Vec3) { return 1.0f; };
  const auto forward = [](Vec3 w) { return w.x < 0 ? 1 + w.x : 0.0f; };
  for (const CoatedMetal& c : CoatedMetals()) {
    TestRandom random(6), again(7);
    constexpr int kCount = 20000;
    const Mean total = MeanOf(kCount, [&](int) { return SimulatePhoton(c, random).weight; });
    const Mean part = MeanOf(kCount, [&](int) {
      const Leaving photon = SimulatePhoton(c, again);
      return photon.weight * forward(photon.w);
    });
    const Mean sampled = Reflected(c, kCount, all), sampled_part = Reflected(c, kCount, forward);
    EXPECT_NEAR(sampled.value, total.value, 4 * (total.error + sampled.error) + 1e-4) << c.Name();
    EXPECT_NEAR(sampled_part.value, part.value, 4 * (part.error + sampled_part.error) + 1e-4) << c.Name();
  }
}

TEST(LayeredConductor, WhiteFurnaceLosesNothing) {
  const SampledSpectrum eta(0.1f), k(1000.0f);  // reflects all but a few millionths
  for (CoatLayer layer : {TestLayer(1e-6f, 0, 0), TestLayer(0.5f, 1, 0.3f)}) {
    layer.depth_max = 1000;
    const LayeredConductorBxdf white(TestInterface(0, 0, 1.5f), {}, eta, k, layer);
    for (const float cos_o : {1.0f, 0.5f, 0.2f}) {
      const Mean albedo = Furnace(white, cos_o, 20000);
      EXPECT_NEAR(albedo.value, 1, 4 * albedo.error + 0.001) << layer.albedo[0] << " " << cos_o;
      EXPECT_LT(albedo.error, 0.02) << layer.albedo[0] << " " << cos_o;
    }
  }
}

TEST(LayeredConductor, SmoothCoatOnAMirrorIsTheSeriesOfItsReflections) {
  CoatLayer layer = TestLayer(0.2f, 0, 0);
  const float cos_o = 0.6f, cos_t = std::sqrt(1 - (1 - cos_o * cos_o) / 2.25f);
  const float coat = FrDielectric(cos_o, 1.5f), metal = FrConductor(cos_t, Float4(0.2f), Float4(3.0f))[0];
  const float crossed = std::exp(-2 * 0.2f / cos_t);
  for (const int depth_max : {0, 1, 2, 5, 10, 1000}) {
    layer.depth_max = depth_max;
    const LayeredConductorBxdf bxdf(TestInterface(0, 0, 1.5f), {}, SampledSpectrum(0.2f),
                                    SampledSpectrum(3.0f), layer);
    double expected = coat;
    for (int i = 0; i < depth_max / 2; ++i) {
      expected += (1 - coat) * (1 - coat) * metal * crossed * std::pow(metal * crossed * coat, i);
    }
    const auto s = bxdf.Sample(DirectionAt(cos_o, 0), 0.99f, {0.5f, 0.5f});
    ASSERT_TRUE(s);
    EXPECT_TRUE(s->IsSpecular());
    EXPECT_EQ(s->pdf, 1);
    EXPECT_NEAR(s->f[0] * cos_o, expected, 1e-5) << depth_max;
  }
}

// Estimates of f at pairs of directions that are turned a little, so that their walks are independent.
Mean Estimates(const LayeredConductorBxdf& bxdf, float cos_o, float cos_i) {
  return MeanOf(20000, [&](int n) {
    const float phi = 1e-4f * static_cast<float>(n);
    return bxdf.Evaluate(DirectionAt(cos_o, phi), DirectionAt(cos_i, phi + 2.5f)).f[0];
  });
}

TEST(LayeredConductor, IsReciprocalOnAverage) {
  for (const float alpha_coat : {0.0f, 0.3f}) {
    const LayeredConductorBxdf bxdf = TestCoatedMetal(alpha_coat, 0.4f, TestLayer(0.3f, 0.7f, 0.3f));
    const Mean there = Estimates(bxdf, 0.9f, 0.4f), back = Estimates(bxdf, 0.4f, 0.9f);
    EXPECT_NEAR(there.value, back.value, 4 * (there.error + back.error)) << alpha_coat;
  }
}

TEST(LayeredConductor, WeightsOfSamplesVaryLittle) {
  for (const float alpha_coat : {0.0f, 0.1f, 0.3f}) {
    for (const float alpha_metal : {0.05f, 0.2f, 0.5f}) {
      for (const float cos_o : {1.0f, 0.5f}) {
        const LayeredConductorBxdf metal = TestCoatedMetal(alpha_coat, alpha_metal, TestLayer(0.01f, 0, 0));
        const Mean albedo = Furnace(metal, cos_o, 10000);
        EXPECT_LT(albedo.error * 100, 4 * albedo.value)
            << "relative deviation of one sample at " << alpha_coat << " " << alpha_metal << " " << cos_o;
      }
    }
  }
}

}  // namespace
}  // namespace tessera
