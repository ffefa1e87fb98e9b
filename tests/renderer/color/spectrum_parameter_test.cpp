#include "renderer/color/spectrum_parameter.h"

#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

using ::testing::HasSubstr;

SpectrumValue RgbValue(Vec3 rgb) {
  SpectrumValue value;
  value.rgb = rgb;
  value.color_space = "srgb";
  value.location.line = 7;
  return value;
}

SpectrumValue NamedValue(const std::string& name) {
  SpectrumValue value;
  value.form = SpectrumValue::Form::kNamed;
  value.name = name;
  value.location.line = 7;
  return value;
}

SpectrumValue SamplesValue(std::vector<float> wavelengths, std::vector<float> values) {
  SpectrumValue value;
  value.form = SpectrumValue::Form::kSamples;
  value.wavelengths = std::move(wavelengths);
  value.values = std::move(values);
  return value;
}

std::string ErrorOf(const SpectrumValue& value, SpectrumUse use, MemoryFiles& files) {
  const Result<Spectrum> spectrum = MakeSpectrum(value, use, files);
  return spectrum ? "" : spectrum.error().message;
}

TEST(MakeSpectrum, RefusesRgbOutsideItsRange) {
  MemoryFiles files;
  EXPECT_EQ(ErrorOf(RgbValue({0, 0.5f, 1}), SpectrumUse::kAlbedo, files), "");
  EXPECT_THAT(ErrorOf(RgbValue({0, 0.5f, 1.5f}), SpectrumUse::kAlbedo, files), HasSubstr("above 1"));
  EXPECT_EQ(ErrorOf(RgbValue({0, 0.5f, 1.5f}), SpectrumUse::kUnbounded, files), "");
  EXPECT_THAT(ErrorOf(RgbValue({0, -0.5f, 1}), SpectrumUse::kUnbounded, files), HasSubstr("negative"));
  EXPECT_THAT(ErrorOf(RgbValue({NAN, 0, 1}), SpectrumUse::kIlluminant, files),
              HasSubstr("negative or not finite"));
  EXPECT_THAT(ErrorOf(RgbValue({0, 0, -1}), SpectrumUse::kAlbedo, files), HasSubstr(":7:1: "));
  SpectrumValue strange = RgbValue({0, 0, 1});
  strange.color_space = "cmyk";
  EXPECT_THAT(ErrorOf(strange, SpectrumUse::kAlbedo, files), HasSubstr("cmyk"));
}

TEST(MakeSpectrum, KnowsNamesBeforeFiles) {
  MemoryFiles files;
  files.files["glass-BK7"] = "400 7 700 7";
  const Result<Spectrum> glass = MakeSpectrum(NamedValue("glass-BK7"), SpectrumUse::kUnbounded, files);
  ASSERT_TRUE(glass);
  EXPECT_NEAR(glass->At(589), 1.5168f, 1e-3);
}

TEST(MakeSpectrum, ReadsFilesOfPairsWithComments) {
  MemoryFiles files;
  files.files["a.spd"] = "# measured\n400 0.5 # first\n\t500.0 1.5e0\r\n+600 2.5";
  const Result<Spectrum> spectrum = MakeSpectrum(NamedValue("a.spd"), SpectrumUse::kUnbounded, files);
  ASSERT_TRUE(spectrum) << spectrum.error().message;
  EXPECT_FLOAT_EQ(spectrum->At(450), 1);
  EXPECT_FLOAT_EQ(spectrum->At(600), 2.5f);
  EXPECT_EQ(spectrum->At(601), 0);
}

TEST(MakeSpectrum, TinyValuesInFilesAreZero) {
  MemoryFiles files;
  files.files = {{"tiny", "400 2.3e-49\n500 1e-400\n600 4e-320 700 1"},
                 {"zero", "400 0\n500 0\n600 0 700 1"}};
  const Result<Spectrum> tiny = MakeSpectrum(NamedValue("tiny"), SpectrumUse::kUnbounded, files);
  const Result<Spectrum> zero = MakeSpectrum(NamedValue("zero"), SpectrumUse::kUnbounded, files);
  ASSERT_TRUE(tiny) << tiny.error().message;
  for (float nm = 400; nm <= 700; nm += 10) EXPECT_EQ(tiny->At(nm), zero->At(nm)) << nm;
}

TEST(MakeSpectrum, RefusesBrokenFilesWithTheReason) {
  MemoryFiles files;
  files.files = {
      {"word", "400 1\n500 one"}, {"odd", "400 1 500"},      {"falling", "500 1 400 1"},
      {"empty", "# nothing\n"},   {"infinite", "400 inf"},   {"negative", "400 -1 500 2"},
      {"glued", "400 1x"},        {"overflow", "400 1e999"}, {"large", std::string(2u << 20, ' ')}};
  const auto error = [&](const char* name) {
    return ErrorOf(NamedValue(name), SpectrumUse::kUnbounded, files);
  };
  EXPECT_THAT(error("word"), HasSubstr("\"word\": line 2 has a word that is not a number"));
  EXPECT_THAT(error("odd"), HasSubstr("no value"));
  EXPECT_THAT(error("falling"), HasSubstr("do not increase"));
  EXPECT_THAT(error("empty"), HasSubstr("no samples"));
  EXPECT_THAT(error("infinite"), HasSubstr("not finite"));
  EXPECT_THAT(error("negative"), HasSubstr("negative"));
  EXPECT_THAT(error("glued"), HasSubstr("not a number"));
  EXPECT_THAT(error("overflow"), HasSubstr("not finite"));
  EXPECT_THAT(error("large"), HasSubstr("allowed"));
  EXPECT_THAT(error("metal-Cu-etha"), HasSubstr("metal-Cu-eta"));
  EXPECT_THAT(error("absent.spd"), HasSubstr("No such file"));
}

TEST(MakeSpectrum, ChecksSamples) {
  MemoryFiles files;
  EXPECT_EQ(ErrorOf(SamplesValue({400, 500}, {1, 2}), SpectrumUse::kUnbounded, files), "");
  EXPECT_THAT(ErrorOf(SamplesValue({400, 400}, {1, 2}), SpectrumUse::kUnbounded, files),
              HasSubstr("do not increase"));
  EXPECT_THAT(ErrorOf(SamplesValue({400}, {1, 2}), SpectrumUse::kUnbounded, files), HasSubstr("no value"));
  EXPECT_THAT(ErrorOf(SamplesValue({}, {}), SpectrumUse::kUnbounded, files), HasSubstr("no samples"));
}

TEST(MakeSpectrum, NoReflectanceIsAboveOne) {
  MemoryFiles files;
  const SpectrumValue value = SamplesValue({360, 830}, {0, 2});
  const Result<Spectrum> albedo = MakeSpectrum(value, SpectrumUse::kAlbedo, files);
  const Result<Spectrum> unbounded = MakeSpectrum(value, SpectrumUse::kUnbounded, files);
  ASSERT_TRUE(albedo && unbounded);
  EXPECT_FLOAT_EQ(albedo->MaxValue(), 1);
  EXPECT_FLOAT_EQ(unbounded->MaxValue(), 2);
}

TEST(MakeSpectrum, BlackbodiesHaveAPositiveTemperature) {
  MemoryFiles files;
  SpectrumValue value;
  value.form = SpectrumValue::Form::kBlackbody;
  value.kelvin = 5000;
  EXPECT_EQ(ErrorOf(value, SpectrumUse::kIlluminant, files), "");
  for (const float kelvin : {0.0f, -10.0f, 1e20f, NAN}) {
    value.kelvin = kelvin;
    EXPECT_THAT(ErrorOf(value, SpectrumUse::kIlluminant, files), HasSubstr("temperature"));
  }
}

TEST(SpectrumParameter, IsTheDefaultWhereNothingIsWrittenAndAnErrorWhereItIsBad) {
  MemoryFiles files;
  Entity entity;
  entity.directive = "Material";
  entity.kind = "diffuse";
  Parameter parameter;
  parameter.type = "rgb";
  parameter.name = "reflectance";
  parameter.floats = {0.5f, 2, 0.5f};
  entity.parameters = {parameter};
  ParameterReader reader(entity);
  const Spectrum missing =
      SpectrumParameter(reader, "transmittance", SpectrumUse::kAlbedo, Spectrum::Constant(0.25f), files);
  EXPECT_EQ(missing.At(500), 0.25f);
  EXPECT_FALSE(reader.failed());
  EXPECT_FALSE(FindSpectrumParameter(reader, "reflectance", SpectrumUse::kAlbedo, files));
  EXPECT_TRUE(reader.failed());
  EXPECT_TRUE(FindSpectrumParameter(reader, "reflectance", SpectrumUse::kUnbounded, files));
}

}  // namespace
}  // namespace tessera
