#include "renderer/medium/medium.h"

#include <gtest/gtest.h>

#include "renderer/color/named_spectra.h"
#include "renderer/medium/scattering_presets.h"
#include "tests/renderer/medium/built_media.h"

namespace tessera {
namespace {

BuiltMedia Homogeneous(const std::string& parameters) {
  return BuildMedia("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" " + parameters);
}

// Of the first medium, which is homogeneous.
HomogeneousCoefficients CoefficientsOf(const BuiltMedia& built, const SampledWavelengths& wavelengths) {
  return std::get<HomogeneousCoefficients>(built.table[0].At(wavelengths));
}

const SampledWavelengths kWavelengths = SampledWavelengths::SampleVisible(0.3f);

void ExpectAll(SampledSpectrum found, float expected) {
  for (int i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(found[i], expected) << i;
}

TEST(Medium, ParametersHaveTheirDefaults) {
  const BuiltMedia built = Homogeneous("");
  ASSERT_EQ(built.error, "");
  const HomogeneousCoefficients at = CoefficientsOf(built, kWavelengths);
  ExpectAll(at.sigma_a, 1);
  ExpectAll(at.sigma_s, 1);
  ExpectAll(at.emission, 0);
  EXPECT_FALSE(built.table[0].is_emissive());
  EXPECT_FLOAT_EQ(built.table[0].phase().Evaluate({0, 0, 1}, {0, 0, 1}), kInv4Pi);
}

TEST(Medium, ScaleMultipliesBothCoefficients) {
  const BuiltMedia built =
      Homogeneous("\"rgb sigma_a\" [ 3 3 3 ] \"spectrum sigma_s\" [ 300 0.5 900 0.5 ] \"float scale\" 2");
  ASSERT_EQ(built.error, "");
  const HomogeneousCoefficients at = CoefficientsOf(built, kWavelengths);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(at.sigma_a[i], 6, 0.06);
  ExpectAll(at.sigma_s, 1);
}

TEST(Medium, PositiveAsymmetryScattersForward) {
  const BuiltMedia built = Homogeneous("\"float g\" 0.5");
  const PhaseFunction& phase = built.table[0].phase();
  EXPECT_GT(phase.Evaluate({0, 0, 1}, {0, 0, -1}), phase.Evaluate({0, 0, 1}, {0, 0, 1}));
}

// As for lights, emission given as a spectrum is normalised to luminance 1; an RGB colour keeps its
// magnitude.
TEST(Medium, EmissionHasUnitLuminanceTimesItsScale) {
  const auto luminance = [](const BuiltMedia& built) {
    double sum = 0, weight = 0;
    for (int i = 0; i < 4000; ++i) {
      const SampledWavelengths w = SampledWavelengths::SampleVisible((static_cast<float>(i) + 0.5f) / 4000);
      const HomogeneousCoefficients at = CoefficientsOf(built, w);
      sum += Average(SafeDiv(SampleTable(CieY(), w) * at.emission, w.pdf));
      weight += 1;
    }
    return sum / weight;
  };
  const std::string absorbing = "\"spectrum sigma_a\" [ 300 0.25 900 0.25 ] ";
  const BuiltMedia black_body = Homogeneous(absorbing + "\"blackbody Le\" 3000 \"float Lescale\" 2");
  ASSERT_EQ(black_body.error, "");
  EXPECT_TRUE(black_body.table[0].is_emissive());
  EXPECT_NEAR(luminance(black_body), 0.25 * 2, 0.01);
  const BuiltMedia rgb = Homogeneous(absorbing + "\"rgb Le\" [ 5 5 5 ]");
  EXPECT_NEAR(luminance(rgb), 0.25 * 5, 0.02);
}

TEST(Medium, DispersionLeavesTheFirstWavelengthAlone) {
  const BuiltMedia skin = Homogeneous("\"string preset\" \"Skin1\"");
  ASSERT_EQ(skin.error, "");
  SampledWavelengths wavelengths = kWavelengths;
  const HomogeneousCoefficients before = CoefficientsOf(skin, wavelengths);
  wavelengths.TerminateSecondary();
  const HomogeneousCoefficients after = CoefficientsOf(skin, wavelengths);
  ExpectAll(after.sigma_a, before.sigma_a[0]);
  ExpectAll(after.sigma_s, before.sigma_s[0]);
  EXPECT_NE(before.sigma_s[0], before.sigma_s[1]);
}

TEST(Medium, EveryPresetIsReadByItsName) {
  EXPECT_EQ(ScatteringPresets().size(), 47u);
  for (const ScatteringPreset& preset : ScatteringPresets()) {
    const BuiltMedia built =
        Homogeneous("\"float scale\" 1000 \"string preset\" \"" + std::string(preset.name) + "\"");
    ASSERT_EQ(built.error, "") << preset.name;
    EXPECT_TRUE(built.diagnostics.warnings().empty());
    // What is the same in all three channels is so at all wavelengths; elsewhere the spectrum is near the
    // channels.
    const HomogeneousCoefficients at = CoefficientsOf(built, kWavelengths);
    const float largest = 1000 * std::max({preset.sigma_a.x, preset.sigma_a.y, preset.sigma_a.z});
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(at.sigma_a[i], 0);
      EXPECT_LE(at.sigma_a[i], 2.01f * largest + 1e-6f) << preset.name;
    }
  }
  EXPECT_EQ(FindScatteringPreset("apple"), nullptr);
  EXPECT_FLOAT_EQ(FindScatteringPreset("Wholemilk")->sigma_s.y, 3.21f);
  EXPECT_FLOAT_EQ(FindScatteringPreset("Merlot")->sigma_a.z, 0.29434f);
}

TEST(Medium, UnknownPresetIsAWarningAndTheCoefficientsApply) {
  const BuiltMedia built = Homogeneous("\"string preset\" \"Marbel\" \"rgb sigma_a\" [ 0 0 0 ]");
  ASSERT_EQ(built.error, "");
  ASSERT_EQ(built.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(built.diagnostics.WarningTexts()[0],
            "m.pbrt:3:49: unknown medium preset \"Marbel\" (did you mean \"Marble\"?): sigma_a and sigma_s "
            "apply instead");
  ExpectAll(CoefficientsOf(built, kWavelengths).sigma_a, 0);
}

TEST(Medium, ErrorsNameTheirPlace) {
  EXPECT_EQ(Homogeneous("\"float g\" 1.5").error, "m.pbrt:3:49: g must lie between -1 and 1");
  EXPECT_EQ(Homogeneous("\"float scale\" -1").error, "m.pbrt:3:49: scale must not be negative");
  EXPECT_EQ(Homogeneous("\"rgb sigma_s\" [ 3e38 0 3e38 ]").error,
            "m.pbrt:3:49: sigma_s is too large: at most 1e20 per scene unit");
  EXPECT_EQ(Homogeneous("\"float Lescale\" -1").error, "m.pbrt:3:49: Lescale must not be negative");
  EXPECT_NE(Homogeneous("\"rgb sigma_a\" [ -1 0 0 ]").error, "");
  EXPECT_NE(
      Homogeneous("\"float sigma\" 1").error.find("unknown parameter \"float sigma\" of MakeNamedMedium"),
      std::string::npos);
  // A preset sets both coefficients: one of them beside it would be ignored.
  EXPECT_NE(Homogeneous("\"string preset\" \"Marble\" \"rgb sigma_a\" [ 1 1 1 ]").error, "");
}

TEST(Medium, UnknownKindsAreNamedWithTheirPlace) {
  EXPECT_EQ(BuildMedia("MakeNamedMedium \"m\" \"string type\" \"homogenous\"").error,
            "m.pbrt:3:1: unknown medium \"homogenous\" (did you mean \"homogeneous\"?)");
}

}  // namespace
}  // namespace tessera
