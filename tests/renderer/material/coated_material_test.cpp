// How scenes describe coated surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/material/material_scene.h"

namespace tessera {
namespace {

TEST(CoatedMaterial, CoatedConductorIsTheConductorIfItsCoatBendsNothing) {
  const std::string metal = R"("rgb reflectance" [0.9 0.5 0.2] )";
  Materials bare("Material \"conductor\" " + metal + R"("float uroughness" 0.04 "float vroughness" 0.16)");
  Materials coated("Material \"coatedconductor\" " + metal +
                   R"("float conductor.uroughness" 0.04 "float conductor.vroughness" 0.16
                      "float interface.eta" 1 "float thickness" 0)");
  ASSERT_EQ(bare.error + coated.error, "");
  const Vec3 wo = DirectionAt(0.8f, 0.3f), wi = DirectionAt(0.7f, 2.9f);
  const SampledSpectrum expected = bare.Evaluate().Evaluate(wo, wi).f;
  const SampledSpectrum f = coated.Evaluate().Evaluate(wo, wi).f;
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(f[i], expected[i], 1e-4f * expected[i]);
}

TEST(CoatedMaterial, MetalUnderACoatHasItsIndexRelativeToTheCoat) {
  Materials m(R"(Material "coatedconductor" "spectrum conductor.eta" [ 300 0.3 900 0.3 ]
                 "spectrum conductor.k" [ 300 3 900 3 ] "float thickness" 0)");
  ASSERT_EQ(m.error, "");
  const auto sample = m.Evaluate().Sample(kUp, 0.5f, {0.5f, 0.5f});
  ASSERT_TRUE(sample && sample->IsSpecular());
  const double metal = 1 - 4 * 0.2 / (1.2 * 1.2 + 4);  // of 0.2 + 2 i, the index relative to 1.5
  double expected = 0.04;
  for (int i = 0; i < 5; ++i) expected += 0.96 * 0.96 * metal * std::pow(metal * 0.04, i);
  EXPECT_NEAR(sample->f[0], expected, 1e-4);
}

TEST(CoatedMaterial, CoatedConductorReadsTheRoughnessOfItsCoat) {
  Materials smooth(R"(Material "coatedconductor")");
  Materials rough(R"(Material "coatedconductor" "float interface.roughness" 0.1)");
  ASSERT_EQ(smooth.error + rough.error, "");
  EXPECT_FALSE(smooth.Evaluate().HasNonSpecular()) << "both interfaces are smooth by default";
  EXPECT_TRUE(rough.Evaluate().HasNonSpecular());
  EXPECT_FALSE(HasFlag(rough.Evaluate().flags(), BxdfFlags::kSpecular));
}

TEST(CoatedMaterial, CoatsWithoutClosedFormAreWalkedToTheSameMean) {
  // A texture of thickness cannot be tabulated; its value is that of the constant one.
  Materials tabulated(R"(Material "coateddiffuse" "float roughness" 0.04 "float thickness" 0.05)");
  Materials walked(R"(Texture "t" "float" "scale" "float tex" 0.05 "float scale" 1
                      Texture "u" "float" "checkerboard" "texture tex1" "t" "texture tex2" "t"
                      Material "coateddiffuse" "float roughness" 0.04 "texture thickness" "u")");
  ASSERT_EQ(tabulated.error + walked.error, "");
  const Bsdf a = tabulated.Evaluate(), b = walked.Evaluate();
  const Vec3 wi = DirectionAt(0.8f, 2.5f);
  double sum = 0;
  constexpr int kCount = 4000;
  for (int n = 0; n < kCount; ++n)
    sum += b.Evaluate(DirectionAt(0.5f, 1e-4f * static_cast<float>(n)), wi).f[0];
  const float expected = a.Evaluate(DirectionAt(0.5f, 0.2f), wi).f[0];
  EXPECT_NEAR(sum / kCount, expected, 0.03f * expected);
}

TEST(CoatedMaterial, TexturedCoatRoughnessUsesATableOfRoughnesses) {
  Materials constant(R"(Material "coateddiffuse" "float roughness" 0.04)");
  Materials textured(R"(Texture "u" "float" "checkerboard" "float tex1" 0.04 "float tex2" 0.04
                        Material "coateddiffuse" "texture roughness" "u")");
  ASSERT_EQ(constant.error + textured.error, "");
  const Vec3 wo = DirectionAt(0.5f, 0), wi = DirectionAt(0.8f, 2.5f);
  const float expected = constant.Evaluate().Evaluate(wo, wi).f[0];
  EXPECT_NEAR(textured.Evaluate().Evaluate(wo, wi).f[0], expected, 0.01f * expected);
}

}  // namespace
}  // namespace tessera
