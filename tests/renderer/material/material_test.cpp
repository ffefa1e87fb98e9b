// From directives to Bsdfs, with relief, mixes and messages.
#include "renderer/material/material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/material/material_scene.h"

namespace tessera {
namespace {

TEST(Material, DiffuseHasItsReflectanceAndDefaultsToHalf) {
  Materials given(R"(Material "diffuse" "spectrum reflectance" [300 0.25 900 0.25])");
  ASSERT_EQ(given.error, "");
  EXPECT_NEAR(AlbedoOf(given.Evaluate()), 0.25f, 1e-5);
  Materials by_default("");
  EXPECT_NEAR(AlbedoOf(by_default.Evaluate()), 0.5f, 1e-5);
}

TEST(Material, EverySupportedKindIsBuilt) {
  for (const std::string_view kind : MaterialKinds().Names()) {
    // These have tests of their own.
    if (kind == "mix" || kind == "measured" || InterfaceMaterial::IsNamed(kind)) continue;
    Materials m("Material \"" + std::string(kind) + "\"");
    ASSERT_EQ(m.error, "") << kind;
    EXPECT_TRUE(m.Evaluate().Sample(m.interaction.wo, 0.01f, {0.3f, 0.6f})) << kind;
    EXPECT_FALSE(m.table.IsInterface(m.last)) << kind;
  }
}

TEST(Material, InterfaceIgnoresItsParameters) {
  Materials m(R"(Material "interface" "float whatever" 3)");
  ASSERT_EQ(m.error, "");
  EXPECT_TRUE(m.table.IsInterface(m.last));
}

TEST(Material, RoughnessIsRemappedByDefault) {
  const auto pdf_at_peak = [](const std::string& parameters) {
    Materials m("Material \"conductor\" " + parameters);
    EXPECT_EQ(m.error, "");
    return m.Evaluate().Evaluate(kUp, kUp).pdf;
  };
  EXPECT_NEAR(pdf_at_peak(R"("float roughness" 0.09)"),
              pdf_at_peak(R"("float roughness" 0.3 "bool remaproughness" false)"), 1e-4);
  Materials mirror(R"(Material "conductor")");
  EXPECT_FALSE(mirror.Evaluate().HasNonSpecular()) << "no roughness is smooth";
}

TEST(Material, ConductorOfAReflectanceReflectsIt) {
  Materials m(R"(Material "conductor" "spectrum reflectance" [300 0.6 900 0.6])");
  ASSERT_EQ(m.error, "");
  const auto sample = m.Evaluate().Sample(kUp, 0.5f, {0.5f, 0.5f});
  ASSERT_TRUE(sample);
  EXPECT_NEAR(sample->f[2], 0.6f, 1e-4);
}

TEST(Material, OnlyDispersionDropsWavelengths) {
  Materials constant(R"(Material "dielectric" "float eta" 1.7)");
  ASSERT_EQ(constant.error, "");
  constant.Evaluate();
  EXPECT_FALSE(constant.wavelengths.SecondaryTerminated());
  for (const char* kind : {"dielectric", "thindielectric", "coateddiffuse"}) {
    Materials glass("Material \"" + std::string(kind) + R"(" "spectrum eta" "glass-BK7")");
    ASSERT_EQ(glass.error, "");
    EXPECT_TRUE(glass.Evaluate().Sample(glass.interaction.wo, 0.01f, {0.3f, 0.6f}));
    EXPECT_TRUE(glass.wavelengths.SecondaryTerminated()) << kind;
  }
  Materials coat(R"(Material "coatedconductor" "spectrum interface.eta" "glass-F11")");
  ASSERT_EQ(coat.error, "");
  coat.Evaluate();
  EXPECT_TRUE(coat.wavelengths.SecondaryTerminated());
}

// Sellmeier's equation with the coefficients of Schott's catalogue. lambda in nm.
double SchottIndex(const std::array<double, 3>& b, const std::array<double, 3>& c, double lambda) {
  const double square = lambda * lambda * 1e-6;
  double n2 = 1;
  for (size_t i = 0; i < 3; ++i) n2 += b[i] * square / (square - c[i]);
  return std::sqrt(n2);
}

void ExpectRefractionBySnell(const std::string& glass, const std::array<double, 3>& b,
                             const std::array<double, 3>& c, double tolerance) {
  for (const float u : {0.05f, 0.3f, 0.6f, 0.9f}) {
    Materials m("Material \"dielectric\" \"spectrum eta\" \"" + glass + "\"");
    ASSERT_EQ(m.error, "");
    m.wavelengths = SampledWavelengths::SampleVisible(u);
    const Vec3 wo = DirectionAt(0.5f, 0);
    const auto sample = m.Evaluate().Sample(wo, 0.99f, {0.5f, 0.5f});
    ASSERT_TRUE(sample && sample->IsTransmission());
    const double index = SchottIndex(b, c, m.wavelengths.lambda[0]);
    EXPECT_NEAR(-wo.x / sample->wi.x, index, tolerance)
        << glass << " at " << m.wavelengths.lambda[0] << " nm";
  }
}

TEST(Material, GlassRefractsEachWavelengthBySnellsLaw) {
  ExpectRefractionBySnell("glass-BK7", {1.03961212, 0.231792344, 1.01046945},
                          {0.00600069867, 0.0200179144, 103.560653}, 2e-4);
  ExpectRefractionBySnell("glass-SF11", {1.73759695, 0.313747346, 1.89878101},
                          {0.013188707, 0.0623068142, 155.23629}, 1e-3);
}

std::string MixOf(const std::string& amount) {
  return R"(MakeNamedMaterial "dark" "string type" "diffuse" "spectrum reflectance" [300 0.1 900 0.1]
            MakeNamedMaterial "light" "string type" "diffuse" "spectrum reflectance" [300 0.9 900 0.9]
            MakeNamedMaterial "both" "string type" "mix" "string materials" ["dark" "light"] "float amount" )" +
         amount + "\nNamedMaterial \"both\"";
}

TEST(Material, MixChoosesEachMaterialInProportionToItsAmount) {
  Materials m(MixOf("0.3"));
  ASSERT_EQ(m.error, "");
  int light = 0;
  constexpr int kCount = 20000;
  for (int n = 0; n < kCount; ++n) {
    m.interaction.p = {0.001f * static_cast<float>(n), 1, 2};
    light += AlbedoOf(m.Evaluate()) > 0.5f;
  }
  EXPECT_NEAR(light / static_cast<double>(kCount), 0.3, 0.015);
}

TEST(Material, MixWithAmountZeroOrOneIsOneMaterial) {
  Materials first(MixOf("0")), second(MixOf("1"));
  for (int n = 0; n < 50; ++n) {
    first.interaction.p.x = second.interaction.p.x = static_cast<float>(n);
    EXPECT_NEAR(AlbedoOf(first.Evaluate()), 0.1f, 1e-5);
    EXPECT_NEAR(AlbedoOf(second.Evaluate()), 0.9f, 1e-5);
  }
}

TEST(Material, MixesNestAndChooseIndependently) {
  Materials m(MixOf("0.5") + R"(
      MakeNamedMaterial "outer" "string type" "mix" "string materials" ["both" "dark"] "float amount" 0.5
      NamedMaterial "outer")");
  ASSERT_EQ(m.error, "");
  int light = 0;
  for (int n = 0; n < 20000; ++n) {
    m.interaction.p = {0.001f * static_cast<float>(n), 1, 2};
    light += AlbedoOf(m.Evaluate()) > 0.5f;
  }
  EXPECT_NEAR(light / 20000.0, 0.25, 0.015);
}

TEST(Material, OnlyDisplacedMaterialsNeedTheDerivativesOfTheNormal) {
  const auto needs = [&](const std::string& material) {
    const Materials m(R"(Texture "c" "float" "checkerboard"
MakeNamedMaterial "plain" "string type" "diffuse"
MakeNamedMaterial "bumped" "string type" "diffuse" "texture displacement" "c"
Material )" + material);
    EXPECT_EQ(m.error, "") << material;
    return m.table.NeedsNormalDerivatives(m.last);
  };
  EXPECT_FALSE(needs(R"("interface")"));
  EXPECT_FALSE(needs(R"("diffuse" "float displacement" 0)"));
  EXPECT_FALSE(needs(R"("mix" "string materials" [ "plain" "plain" ])"));
  EXPECT_TRUE(needs(R"("conductor" "float displacement" 0.1)"));
  EXPECT_TRUE(needs(R"("diffuse" "texture displacement" "c")"));
  EXPECT_TRUE(needs(R"("mix" "string materials" [ "plain" "bumped" ])"));
}

TEST(Material, OnlyMaterialsThatScatterOrReadAlongTangentsNeedThem) {
  const auto needs = [&](const std::string& material) {
    const Materials m(R"(Texture "c" "float" "checkerboard" Texture "s" "spectrum" "checkerboard"
MakeNamedMaterial "plain" "string type" "diffuse"
MakeNamedMaterial "brushed" "string type" "conductor" "float uroughness" 0.1 "float vroughness" 0.4
Material )" + material);
    EXPECT_EQ(m.error, "") << material;
    return m.table.NeedsTangents(m.last);
  };
  for (const char* isotropic : {R"("interface")", R"("diffuse")", R"("diffusetransmission")",
                                R"("thindielectric")", R"("conductor" "float roughness" 0.2)",
                                R"("dielectric" "float uroughness" 0.2 "float vroughness" 0.2)",
                                R"("coateddiffuse" "float roughness" 0.3)", R"("coatedconductor")",
                                R"("subsurface")", R"("mix" "string materials" [ "plain" "plain" ])"}) {
    EXPECT_FALSE(needs(isotropic)) << isotropic;
  }
  for (const char* along :
       {R"("hair")", R"("conductor" "float uroughness" 0.2)", R"("dielectric" "float vroughness" 0.2)",
        R"("coateddiffuse" "float uroughness" 0.3 "float vroughness" 0.2)",
        R"("coatedconductor" "float interface.uroughness" 0.5)",
        R"("coatedconductor" "float conductor.vroughness" 0.5)", R"("subsurface" "float uroughness" 0.5)",
        R"("diffuse" "texture reflectance" "s")", R"("diffuse" "texture displacement" "c")",
        R"("mix" "string materials" [ "plain" "brushed" ])"}) {
    EXPECT_TRUE(needs(along)) << along;
  }
}

TEST(Material, OnlyMaterialsThatReadTexturesNeedTheFootprint) {
  const std::string checks = R"(Texture "c" "float" "checkerboard" Texture "s" "spectrum" "checkerboard"
MakeNamedMaterial "plain" "string type" "diffuse"
MakeNamedMaterial "checked" "string type" "diffuse" "texture reflectance" "s"
)";
  const auto needs = [&](const std::string& material) {
    const Materials m(checks + "Material " + material);
    EXPECT_EQ(m.error, "") << material;
    return m.table.NeedsFootprint(m.last);
  };
  for (const char* plain : {R"("interface")", R"("diffuse")", R"("dielectric" "float roughness" 0.2)",
                            R"("conductor" "float uroughness" 0.2)", R"("coateddiffuse" "float g" 0.5)",
                            R"("coatedconductor" "float conductor.roughness" 0.5)", R"("hair")",
                            R"("mix" "string materials" [ "plain" "plain" ])"}) {
    EXPECT_FALSE(needs(plain)) << plain;
  }
  for (const char* textured :
       {R"("diffuse" "texture reflectance" "s")", R"("diffuse" "texture displacement" "c")",
        R"("diffuse" "string normalmap" "tilted.pfm")",
        R"("diffusetransmission" "texture transmittance" "s")", R"("conductor" "texture k" "s")",
        R"("dielectric" "texture vroughness" "c")", R"("coateddiffuse" "texture thickness" "c")",
        R"("hair" "texture eumelanin" "c")", R"("hair" "texture color" "s")", R"("hair" "texture alpha" "c")",
        R"("coatedconductor" "texture interface.vroughness" "c")",
        R"("coatedconductor" "texture conductor.k" "s")", R"("coatedconductor" "texture albedo" "s")",
        R"("mix" "texture amount" "c" "string materials" [ "plain" "plain" ])",
        R"("mix" "string materials" [ "plain" "checked" ])"}) {
    EXPECT_TRUE(needs(textured)) << textured;
  }
}

TEST(Material, FlatDisplacementLeavesTheNormal) {
  for (const char* height : {"0", "0.7"}) {
    Materials m(R"(Texture "h" "float" "checkerboard" "float tex1" )" + std::string(height) +
                R"( "float tex2" )" + height + R"( Material "diffuse" "texture displacement" "h")");
    ASSERT_EQ(m.error, "");
    m.Evaluate();
    EXPECT_EQ(m.interaction.shading.n, kUp);
    EXPECT_EQ(m.interaction.shading.dpdu, (Vec3{2, 0, 0}));
  }
}

TEST(Material, SlopeOfTheDisplacementTiltsTheNormal) {
  // Height u: over dpdu of length 2, a slope of 1/2 along x.
  Materials m(R"(Texture "h" "float" "bilerp" "float v00" 0 "float v01" 0 "float v10" 1 "float v11" 1
                 Material "diffuse" "texture displacement" "h")");
  ASSERT_EQ(m.error, "");
  m.Evaluate();
  EXPECT_NEAR(Distance(m.interaction.shading.n, Normalize({-0.5f, 0, 1})), 0, 1e-3);
  EXPECT_NEAR(Dot(m.interaction.shading.n, m.interaction.shading.dpdu), 0, 1e-3);
  EXPECT_EQ(m.interaction.n, kUp) << "the true surface stays";
}

TEST(Material, NormalMapSetsTheNormalOfItsImage) {
  Materials m(R"(Material "diffuse" "string normalmap" "tilted.pfm")");
  ASSERT_EQ(m.error, "");
  m.Evaluate();
  EXPECT_NEAR(Distance(m.interaction.shading.n, Vec3{0.6f, 0, 0.8f}), 0, 1e-5);
  EXPECT_NEAR(Length(m.interaction.shading.dpdu), 2, 1e-4);
  EXPECT_NEAR(Length(m.interaction.shading.dpdv), 3, 1e-4);
  EXPECT_NEAR(Dot(m.interaction.shading.dpdu, m.interaction.shading.n), 0, 1e-4);
}

struct BadMaterial {
  const char* directives;
  const char* message;
};

TEST(Material, ErrorsNameTheirPlace) {
  const BadMaterial bad[] = {
      {R"(Material "difuse")", "test.pbrt:2:1: unknown material \"difuse\" (did you mean \"diffuse\"?)"},
      {R"(MakeNamedMaterial "x" "string type" "plastic")", "test.pbrt:2:1: unknown material \"plastic\""},
      {R"(Material "diffuse" "float roughness" 1)", "roughness"},
      {R"(Material "conductor" "rgb reflectance" [1 1 1] "rgb k" [1 1 1])", "not both"},
      {R"(Material "coatedconductor" "rgb reflectance" [1 1 1] "rgb conductor.k" [1 1 1])",
       "test.pbrt:2:28: a conductor has either \"reflectance\" or \"conductor.eta\" and \"conductor.k\""},
      {R"(Material "coatedconductor" "float interface.eta" 2000)",
       "\"interface.eta\" must be from 0 to 1000"},
      {R"(Material "coatedconductor" "integer nsamples" 0)", "\"nsamples\" of a coat must be from 1 to 1024"},
      {R"(Material "coatedconductor" "float conductor.roughnes" 0)", "did you mean \"conductor.roughness\"?"},
      {R"(Material "hair" "float beta_x" 1)",
       "test.pbrt:2:17: unknown parameter \"float beta_x\" of Material \"hair\" (did you mean"},
      {R"(Material "hair" "float displacement" 1)",
       "test.pbrt:2:17: unknown parameter \"float displacement\""},
      {R"(Material "hair" "rgb reflectance" [2 0 0])", "above 1"},
      {R"(Material "dielectric" "float eta" -1)", "\"eta\" must be from 0 to 1000"},
      {R"(Material "coateddiffuse" "integer nsamples" 0)", "\"nsamples\" of a coat must be from 1"},
      {R"(Material "coateddiffuse" "integer maxdepth" 2000000)", "\"maxdepth\" of a coat must be from 0"},
      {R"(Material "mix" "string materials" "one")", "needs 2 names, not 1"},
      {R"(MakeNamedMaterial "wood" "string type" "diffuse" Material "mix" "string materials" ["wood" "wod"])",
       "material \"wod\" is not defined (did you mean \"wood\"?)"},
      {R"(MakeNamedMaterial "m" "string type" "mix" "string materials" ["m" "m"])",
       "must be defined before it is mixed"},
      {R"(MakeNamedMaterial "i" "string type" "interface" Material "mix" "string materials" ["i" "i"])",
       "material \"i\" is an interface"},
      {R"(Material "diffuse" "string normalmap" "none.png")", "none.png"},
      {R"(Material "diffuse" "string normalmap" "grey.pfm")", "needs the channels R, G and B"},
  };
  for (const BadMaterial& example : bad) {
    Materials m(example.directives);
    EXPECT_THAT(m.error, testing::HasSubstr(example.message)) << example.directives;
    EXPECT_THAT(m.error, testing::StartsWith("test.pbrt:2:")) << example.directives;
  }
}

}  // namespace
}  // namespace tessera
