#include "renderer/color/named_spectra.h"

#include <cmath>
#include <numeric>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "renderer/color/rgb_primaries.h"

namespace tessera {
namespace {

float At(std::string_view name, float lambda) {
  const std::shared_ptr<const DenseTable> table = NamedSpectrum(name);
  return table ? Spectrum::Table(table).At(lambda) : NAN;
}

Chromaticity ChromaticityOf(const DenseTable& spectrum) {
  const std::array<double, 3> xyz = XyzOf(spectrum);
  const double sum = xyz[0] + xyz[1] + xyz[2];
  return {xyz[0] / sum, xyz[1] / sum};
}

TEST(CieCurves, IntegralsArePublishedOnes) {
  const auto integral = [](const DenseTable& table) {
    return std::accumulate(table.begin(), table.end(), 0.0);
  };
  // Equal energy is white: all three are alike.
  EXPECT_NEAR(integral(CieY()), static_cast<double>(kCieYIntegral), 1e-4);
  EXPECT_NEAR(integral(CieX()), 106.8655, 1e-3);
  EXPECT_NEAR(integral(CieZ()), 106.8923, 1e-3);
}

TEST(CieCurves, PeaksLieWhereTheyShould) {
  EXPECT_EQ(CieY()[555 - kLambdaMin], 1.0f);
  EXPECT_FLOAT_EQ(CieX()[600 - kLambdaMin], 1.0622f);
  EXPECT_FLOAT_EQ(CieZ()[445 - kLambdaMin], 1.7826f);
  EXPECT_FLOAT_EQ(CieX()[504 - kLambdaMin], 0.002236293f);
}

TEST(NamedSpectra, HoldPublishedValues) {
  EXPECT_NEAR(At("metal-Ag-eta", 500), 0.13f, 1e-3);
  EXPECT_NEAR(At("metal-Al-k", 600), 7.2567f, 2e-3);
  EXPECT_NEAR(At("metal-Au-eta", 450), 1.5085f, 2e-3);
  EXPECT_NEAR(At("metal-Cu-k", 620), 3.2411f, 2e-3);
  EXPECT_NEAR(At("metal-CuZn-eta", 550), 0.527f, 1e-6);
  EXPECT_NEAR(At("metal-MgO-eta", 546), 1.74078f, 1e-4);
  EXPECT_NEAR(At("metal-TiO2-eta", 500), 3.03f, 1e-3);
  // Indices at the sodium line, of Schott's catalogue.
  EXPECT_NEAR(At("glass-BK7", 589), 1.5168f, 2e-4);
  EXPECT_NEAR(At("glass-SF11", 589), 1.7844f, 6e-4);
  EXPECT_NEAR(At("glass-FK51A", 589), 1.4865f, 2e-4);
}

TEST(NamedSpectra, GlassesHaveBothSpellings) {
  for (const char* number : {"5", "10", "11"}) {
    const auto schott = NamedSpectrum(std::string("glass-SF") + number);
    const auto short_name = NamedSpectrum(std::string("glass-F") + number);
    ASSERT_TRUE(schott && short_name);
    EXPECT_EQ(*schott, *short_name);
  }
}

TEST(NamedSpectra, UnknownNamesAreNull) {
  EXPECT_EQ(NamedSpectrum("metal-Xx-eta"), nullptr);
  EXPECT_EQ(NamedSpectrum(""), nullptr);
}

TEST(NamedSpectra, NamesAreDifferentAndAllResolve) {
  std::set<std::string_view> names;
  for (const std::string_view name : NamedSpectrumNames()) {
    EXPECT_TRUE(names.insert(name).second) << name;
    const auto table = NamedSpectrum(name);
    ASSERT_NE(table, nullptr) << name;
    for (const float value : *table) ASSERT_TRUE(value >= 0 && std::isfinite(value)) << name;
  }
  EXPECT_EQ(names.size(), 7u + 3u + 2u * 7u + 16u + 3u * SensorNames().size());
  EXPECT_EQ(SensorNames().size(), 17u);
}

TEST(NamedSpectra, SensorsAreScaledToTheirLargestGreenSensitivity) {
  for (const std::string_view sensor : SensorNames()) {
    const auto green = NamedSpectrum(std::string(sensor) + "_g");
    ASSERT_TRUE(green) << sensor;
    EXPECT_EQ(*std::max_element(green->begin(), green->end()), 1) << sensor;
    EXPECT_EQ((*green)[520 - kLambdaMin], 1) << sensor;
    // Red sees the longest wavelengths, blue the shortest.
    const auto red = NamedSpectrum(std::string(sensor) + "_r"),
               blue = NamedSpectrum(std::string(sensor) + "_b");
    ASSERT_TRUE(red && blue) << sensor;
    const auto largest = [](const DenseTable& table) {
      return std::max_element(table.begin(), table.end()) - table.begin() + kLambdaMin;
    };
    EXPECT_GE(largest(*red), 590) << sensor;
    EXPECT_LE(largest(*red), 600) << sensor;
    EXPECT_GE(largest(*blue), 460) << sensor;
    EXPECT_LE(largest(*blue), 480) << sensor;
  }
}

TEST(NamedSpectra, ColorCheckerPatchesHaveTheirColours) {
  ASSERT_EQ(ColorCheckerPatches().size(), 24u);
  const DenseTable& red = ColorCheckerPatches()[14];
  EXPECT_LT(red[550 - kLambdaMin], 0.06f);
  EXPECT_GT(red[650 - kLambdaMin], 0.6f);
  EXPECT_EQ(red[360 - kLambdaMin], red[380 - kLambdaMin]);  // constant beyond the samples
  for (size_t grey = 18; grey < 24; ++grey) {
    const DenseTable& patch = ColorCheckerPatches()[grey];
    EXPECT_NEAR(patch[450 - kLambdaMin] / patch[650 - kLambdaMin], 1, 0.1f);
  }
}

TEST(NamedSpectra, IndicesOfRefractionGoOnBeyondTheirSamples) {
  // BAF10 begins at 350 nm, LASF9 at 370 nm; MgO ends at 768 nm.
  EXPECT_FLOAT_EQ(At("glass-LASF9", 360), 1.9199725545705f);
  EXPECT_FLOAT_EQ(At("metal-MgO-eta", 830), 1.72872f);
}

TEST(Illuminants, HaveTheChromaticityOfTheirStandard) {
  // CIE 15, tables T.3 and T.6.1, for the 2-degree observer; D50 is pbrt's, somewhat bluer than CIE's
  // (0.3457, 0.3585).
  const struct {
    const char* name;
    double x, y;
  } kExpected[] = {{"stdillum-A", 0.44757, 0.40745},   {"stdillum-D50", 0.33681, 0.35798},
                   {"stdillum-D65", 0.31272, 0.32903}, {"illum-acesD60", 0.32168, 0.33767},
                   {"stdillum-F1", 0.3131, 0.3371},    {"stdillum-F2", 0.3721, 0.3751},
                   {"stdillum-F3", 0.4091, 0.3941},    {"stdillum-F4", 0.4402, 0.4031},
                   {"stdillum-F5", 0.3138, 0.3452},    {"stdillum-F6", 0.3779, 0.3882},
                   {"stdillum-F7", 0.3129, 0.3292},    {"stdillum-F8", 0.3458, 0.3586},
                   {"stdillum-F9", 0.3741, 0.3727},    {"stdillum-F10", 0.3458, 0.3588},
                   {"stdillum-F11", 0.3805, 0.3769},   {"stdillum-F12", 0.4370, 0.4042}};
  for (const auto& expected : kExpected) {
    const Chromaticity found = ChromaticityOf(*NamedSpectrum(expected.name));
    EXPECT_NEAR(found.x, expected.x, 4e-4) << expected.name;
    EXPECT_NEAR(found.y, expected.y, 4e-4) << expected.name;
  }
}

TEST(Illuminants, AreScaledToALuminanceOfOne) {
  for (const char* name : {"stdillum-A", "stdillum-D65", "stdillum-F12", "illum-acesD60"}) {
    EXPECT_NEAR(SpectrumToPhotometric(Spectrum::Table(NamedSpectrum(name))), kCieYIntegral, 1e-3) << name;
  }
}

TEST(TableFromSamples, InterpolatesLinearlyAndIsZeroOutside) {
  const float wavelengths[] = {400, 500, 510.5f}, values[] = {1, 3, 0.5f};
  const auto table = TableFromSamples(wavelengths, values);
  const auto at = [&](int lambda) { return (*table)[static_cast<size_t>(lambda - kLambdaMin)]; };
  EXPECT_EQ(at(399), 0);
  EXPECT_EQ(at(400), 1);
  EXPECT_FLOAT_EQ(at(425), 1.5f);
  EXPECT_FLOAT_EQ(at(500), 3);
  EXPECT_NEAR(at(510), 0.5f + 2.5f * 0.5f / 10.5f, 1e-6);
  EXPECT_EQ(at(511), 0);
}

TEST(Blackbody, FollowsPlanckAndWien) {
  // 2.8977721e6 nm K / 5000 K = 579.55 nm.
  const auto table = Blackbody(5000);
  const auto peak = std::max_element(table->begin(), table->end());
  EXPECT_NEAR(static_cast<double>(peak - table->begin()) + kLambdaMin, 579.55, 1);
  EXPECT_NEAR(*peak, 1, 1e-5);
  const auto planck = [](double lambda_nm) {
    return 1 / (std::pow(lambda_nm, 5) * (std::exp(1.4387770e7 / (lambda_nm * 5000)) - 1));
  };
  for (const int lambda : {360, 450, 700, 830}) {
    EXPECT_NEAR((*table)[static_cast<size_t>(lambda - kLambdaMin)], planck(lambda) / planck(579.55442), 1e-5);
  }
}

TEST(Blackbody, IsFiniteAtAnyTemperature) {
  for (const float kelvin : {1e-30f, 1e-3f, 1.0f, 300.0f, 1e6f, 1e8f, -5.0f, 0.0f}) {
    const std::shared_ptr<const DenseTable> table = Blackbody(kelvin);
    for (const float value : *table) {
      ASSERT_TRUE(value >= 0 && value <= 1.00001f) << kelvin << " K: " << value;
    }
  }
}

TEST(DaylightIlluminant, At6504KIsD65) {
  const Chromaticity found = ChromaticityOf(*DaylightIlluminant(6504 * 1.4380f / 1.4388f));
  EXPECT_NEAR(found.x, 0.31272, 3e-4);
  EXPECT_NEAR(found.y, 0.32903, 3e-4);
  EXPECT_EQ(*DaylightIlluminant(3000), *Blackbody(3000 * (1.4388f / 1.4380f)));
}

}  // namespace
}  // namespace tessera
