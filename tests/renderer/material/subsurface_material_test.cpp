// How scenes describe light that is scattered below a surface.
#include <gtest/gtest.h>

#include "tests/renderer/material/material_scene.h"

namespace tessera::subsurface_materials {
namespace {

// What leaves at a distance from the point that the material is evaluated at.
SampledSpectrum Profile(const std::string& parameters, float distance = 0.5f) {
  Materials m(
      "Texture \"grey\" \"spectrum\" \"constant\" \"rgb value\" [ 0.5 0.5 0.5 ]\nMaterial \"subsurface\" " +
      parameters);
  EXPECT_EQ(m.error, "") << parameters;
  m.Evaluate();
  EXPECT_TRUE(m.table.ScattersBelow(m.last));
  const auto below = m.table.SubsurfaceAt(m.last, m.textures, m.context, m.interaction, m.wavelengths);
  EXPECT_TRUE(below);
  return below->bssrdf.Evaluate(m.interaction.p + Vec3{distance, 0, 0});
}

void ExpectSame(SampledSpectrum a, SampledSpectrum b, const char* what) {
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(a[i], 0) << what;
    EXPECT_NEAR(a[i], b[i], 2e-3f * a[i]) << what;
  }
}

TEST(SubsurfaceMaterial, IsGivenByANameCoefficientsReflectanceOrNothing) {
  const SampledSpectrum plain = Profile("");
  ExpectSame(plain, Profile(R"("rgb sigma_a" [ .0011 .0024 .014 ] "rgb sigma_s" [ 2.55 3.21 3.77 ])"),
             "default");
  ExpectSame(
      Profile(R"("string name" "Skin1")"),
      Profile(R"("string name" "Skin1" "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 1 1 1 ] "float g" 0.5)"),
      "a name counts first, without g");
  ExpectSame(Profile(R"("rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 1 1 1 ])"),
             Profile(R"("rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 1 1 1 ] "rgb reflectance" [ 0.1 0.1 0.1 ])"),
             "coefficients count before the reflectance");
  ExpectSame(Profile(R"("texture reflectance" "grey")"), Profile(R"("rgb reflectance" [ 0.5 0.5 0.5 ])"),
             "texture");
}

TEST(SubsurfaceMaterial, ScaleMultipliesCoefficientsAndTheMeanFreePath) {
  ExpectSame(Profile(R"("rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 4 4 4 ] "float scale" 0.5)"),
             Profile(R"("rgb sigma_a" [ .5 .5 .5 ] "rgb sigma_s" [ 2 2 2 ])"), "coefficients");
  ExpectSame(Profile(R"("rgb reflectance" [ .5 .5 .5 ] "rgb mfp" [ .1 .1 .1 ] "float scale" 3)"),
             Profile(R"("rgb reflectance" [ .5 .5 .5 ] "rgb mfp" [ .3 .3 .3 ])"), "mfp");
}

TEST(SubsurfaceMaterial, ExtremeParametersStayFinite) {
  for (const char* parameters :
       {R"("rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0 0 0 ])",
        R"("rgb sigma_a" [ 1e30 1 1 ] "rgb sigma_s" [ 1e30 0 1e30 ])",
        R"("rgb reflectance" [ 1 0 1 ] "rgb mfp" [ 0 1e30 1 ])", R"("float eta" 0.1)",
        R"("float eta" 10 "float g" 1)", R"("float g" -1 "float eta" 1)"}) {
    Materials m(std::string("Material \"subsurface\" ") + parameters);
    ASSERT_EQ(m.error, "") << parameters;
    m.Evaluate();
    const auto below = m.table.SubsurfaceAt(m.last, m.textures, m.context, m.interaction, m.wavelengths);
    ASSERT_TRUE(below);
    for (const float x : {0.0f, 1e-6f, 0.3f, 1e6f}) {
      const Point3 p = m.interaction.p + Vec3{x, 0, 0};
      const SampledSpectrum value = below->bssrdf.Evaluate(p), pdf = below->bssrdf.Pdf(p, {0, 0, 1});
      for (int i = 0; i < 4; ++i) {
        EXPECT_TRUE(std::isfinite(value[i]) && value[i] >= 0)
            << parameters << " at " << x << ": " << value[i];
        EXPECT_TRUE(std::isfinite(pdf[i]) && pdf[i] >= 0) << parameters << " at " << x << ": " << pdf[i];
      }
    }
    if (const auto probe = below->bssrdf.SampleProbe(0.7f, {0.5f, 0.5f})) {
      EXPECT_TRUE(std::isfinite(Length(probe->along)) && std::isfinite(Length(probe->from))) << parameters;
    }
  }
}

TEST(SubsurfaceMaterial, MaterialsWithTheSameInsideShareATable) {
  Materials m(
      R"(Material "subsurface" Material "subsurface" "rgb reflectance" [ 1 1 1 ] Material "diffuse")");
  ASSERT_EQ(m.error, "");
  EXPECT_TRUE(m.table.AnyScattersBelow());
  EXPECT_FALSE(m.table.ScattersBelow(m.last));
}

TEST(SubsurfaceMaterial, ErrorsNameTheirPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {R"("string name" "Skin")",
       "test.pbrt:2:23: unknown scattering medium \"Skin\" (did you mean \"Skin1\"?)"},
      {R"("rgb sigma_a" [ 1 1 1 ])", "test.pbrt:2:23: \"sigma_a\" and \"sigma_s\" belong together"},
      {R"("float eta" 0)", "test.pbrt:2:23: \"eta\" must be from 0.1 to 10"},
      {R"("float g" 2)", "test.pbrt:2:23: \"g\" must be from -1 to 1"},
      {R"("float scale" -1)", "test.pbrt:2:23: \"scale\" must not be negative"},
  };
  for (const auto& [parameters, message] : cases) {
    const Materials m(std::string("Material \"subsurface\" ") + parameters);
    EXPECT_EQ(m.error, message);
  }
}

}  // namespace
}  // namespace tessera::subsurface_materials
