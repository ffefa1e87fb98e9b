#include "renderer/bssrdf/diffusion_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "renderer/bssrdf/catmull_rom.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

TEST(CatmullRom, WeightsReproduceLinesAndIntegralsOfThem) {
  const std::vector<float> nodes{0, 1, 1.5f, 4, 5}, line{1, 3, 4, 9, 11};
  for (float x = 0; x <= 5; x += 0.13f) {
    const auto w = CatmullRomWeights(nodes, x);
    ASSERT_TRUE(w);
    float value = 0;
    for (int i = 0; i < 4; ++i) {
      const float weight = w->weights[static_cast<size_t>(i)];
      if (weight != 0) value += weight * line[static_cast<size_t>(w->offset + i)];
    }
    EXPECT_NEAR(value, 1 + 2 * x, 1e-4);
    EXPECT_NEAR(InvertCatmullRom(nodes, line, 1 + 2 * x), x, 1e-4);
  }
  std::vector<float> before(5);
  EXPECT_NEAR(IntegrateCatmullRom(nodes, line, before), 5 + 25, 1e-4);
  EXPECT_NEAR(before[3], 4 + 16, 1e-4);
  EXPECT_FALSE(CatmullRomWeights(nodes, -0.1f));
  EXPECT_FALSE(CatmullRomWeights(nodes, NAN));
}

TEST(DiffusionProfile, EffectiveAlbedoIsTheIntegralAndRises) {
  const DiffusionProfile profile(0, 1.33f);
  float last = 0;
  for (const float albedo : {0.2f, 0.6f, 0.9f, 0.99f, 0.9995f}) {
    double sum = 0;
    constexpr int kSteps = 20000;
    const double end = std::log(100.0 / 1e-4);
    for (int i = 0; i < kSteps; ++i) {
      const double r = 1e-4 * std::exp((i + 0.5) / kSteps * end);
      sum += static_cast<double>(profile.Evaluate(profile.PlaceOf(albedo), static_cast<float>(r))) * 2 *
             M_PI * r * r * end / kSteps;
    }
    EXPECT_NEAR(sum, profile.EffectiveAlbedo(profile.PlaceOf(albedo)), 0.01 * sum) << albedo;
    EXPECT_GT(profile.EffectiveAlbedo(profile.PlaceOf(albedo)), last);
    last = profile.EffectiveAlbedo(profile.PlaceOf(albedo));
    EXPECT_NEAR(profile.AlbedoOf(last), albedo, 2e-3);
  }
  EXPECT_LT(last, 1.02f);
}

TEST(DiffusionProfile, SampledRadiiFollowTheProfile) {
  const DiffusionProfile profile(0, 1.5f);
  TestRandom random(3);
  for (const float albedo : {0.5f, 0.95f}) {
    constexpr int kCount = 100000, kBins = 20;
    std::vector<double> observed(kBins);
    for (int n = 0; n < kCount; ++n) {
      const auto radius = profile.SampleRadius(profile.PlaceOf(albedo), random.Next());
      ASSERT_TRUE(radius);
      const int bin = static_cast<int>(*radius / 0.2f);
      if (bin < kBins) ++observed[static_cast<size_t>(bin)];
    }
    for (int bin = 0; bin < kBins; ++bin) {
      double expected = 0;
      for (int i = 0; i < 200; ++i) {
        const float r = 0.2f * (static_cast<float>(bin) + (static_cast<float>(i) + 0.5f) / 200);
        expected +=
            static_cast<double>(profile.Evaluate(profile.PlaceOf(albedo), r) * 2 * 3.14159265f * r * 0.001f);
      }
      expected *= kCount / static_cast<double>(profile.EffectiveAlbedo(profile.PlaceOf(albedo)));
      EXPECT_NEAR(observed[static_cast<size_t>(bin)], expected, 5 * std::sqrt(expected) + 5)
          << albedo << " " << bin;
    }
  }
}

}  // namespace
}  // namespace tessera
