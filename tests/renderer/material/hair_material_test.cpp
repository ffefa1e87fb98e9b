// How scenes describe hair.
#include <gtest/gtest.h>

#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/material/material_scene.h"

namespace tessera {
namespace {

SampledSpectrum HairColor(const std::string& parameters) {
  Materials m("Texture \"one\" \"float\" \"checkerboard\" \"float tex2\" 1\n" +
              ("Material \"hair\" " + parameters));
  EXPECT_EQ(m.error, "") << parameters;
  return m.Evaluate().Evaluate(DirectionAt(0.8f, 0), DirectionAt(0.6f, 2)).f;
}

void ExpectSameColor(SampledSpectrum a, SampledSpectrum b) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], 2e-3f * a[i]);
}

TEST(HairMaterial, HairIsColoredByAbsorptionReflectanceOrMelanin) {
  const SampledSpectrum brown = HairColor("");
  ExpectSameColor(brown, HairColor(R"("float eumelanin" 1.3)"));
  ExpectSameColor(brown, HairColor(R"("rgb sigma_a" [ 0.5447 0.9061 1.781 ])"));
  const SampledSpectrum red = HairColor(R"("float pheomelanin" 1)");
  ExpectSameColor(red, HairColor(R"("texture pheomelanin" "one")"));
  ExpectSameColor(red, HairColor(R"("rgb sigma_a" [ 0.187 0.4 1.05 ])"));
  EXPECT_NE(red[0], brown[0]);
  const SampledSpectrum grey = HairColor(R"("spectrum reflectance" [ 300 0.5 900 0.5 ])");
  ExpectSameColor(grey, HairColor(R"("spectrum color" [ 300 0.5 900 0.5 ])"));
  ExpectSameColor(grey, HairColor(R"("spectrum sigma_a" [ 300 0.0138565 900 0.0138565 ])"));
}

TEST(HairMaterial, HairTakesOneColorAndWarnsOfOthers) {
  Materials m(R"(Material "hair" "float eumelanin" 8 "rgb color" [ 1 1 1 ] "rgb sigma_a" [ 1 1 1 ])");
  ASSERT_EQ(m.error, "");
  ASSERT_EQ(m.Warnings().size(), 2u);
  EXPECT_EQ(m.Warnings()[0].message, "\"color\" of hair is ignored because there is \"sigma_a\"");
  EXPECT_EQ(m.Warnings()[1].message, "\"eumelanin\" of hair is ignored because there is \"sigma_a\"");
  Materials melanin(R"(Material "hair" "float eumelanin" 8 "rgb color" [ 1 1 1 ])");
  ASSERT_EQ(melanin.Warnings().size(), 1u);
}

TEST(HairMaterial, VRunsAcrossTheWidthOfHair) {
  Materials m(R"(Material "hair" "float beta_n" 0.1 "float alpha" 0)");
  m.interaction.uv = {0.3f, 0.5f};
  const float middle = m.Evaluate().Evaluate(kUp, DirectionAt(-1, 0)).f[0];
  m.interaction.uv = {0.9f, 0.5f};
  EXPECT_EQ(m.Evaluate().Evaluate(kUp, DirectionAt(-1, 0)).f[0], middle);
  m.interaction.uv = {0.3f, 0.95f};
  EXPECT_LT(m.Evaluate().Evaluate(kUp, DirectionAt(-1, 0)).f[0], 0.1f * middle) << "refracted aside";
}

}  // namespace
}  // namespace tessera
